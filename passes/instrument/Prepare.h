//===- Prepare.h - Makes the copy that is analysed ------------------------===//
//
// The analysis needs local variables as SSA values, and small library functions
// (accessors of messages, std::max, the arrow of a smart pointer) inlined, so
// that each use is analysed by itself. This is done to a copy, and the findings
// are mapped back: the user gets the program that the compiler would have built
// without TPC, at every optimisation level. The findings are also the same at
// every level.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_PREPARE_H
#define TPC_PREPARE_H

#include "instrument/CallNumbers.h"
#include "instrument/Separation.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/STLFunctionalExtras.h"
#include "llvm/IR/InstrTypes.h"
#include "llvm/IR/Instruction.h"
#include "llvm/IR/Module.h"
#include "llvm/IR/PassManager.h"
#include "llvm/IR/ValueHandle.h"
#include "llvm/Transforms/Utils/ValueMapper.h"

#include <memory>

namespace tpc {

struct Options;
class Rules;
struct Rule;

/// The analysed copy of a module to instrument. The original module does not
/// change.
class AnalysedModule {
public:
  AnalysedModule(llvm::Module &M, const Options &Opts,
                 std::shared_ptr<const Rules> Tables);

  llvm::Module &module() { return *Copy; }

  /// Copies each of \p Names for each of its calls. \p BeforeChange is called
  /// before module() changes. If none can be copied, returns false and changes
  /// nothing.
  bool separate(std::vector<std::string> Names,
                llvm::function_ref<void()> BeforeChange);

  /// True if bringBack() changes the original module.
  bool isSeparated() const { return IsSeparated; }
  /// The functions that separate() copied, round by round.
  llvm::ArrayRef<std::vector<CopiedFunction>> copied() const { return Copied; }
  /// Applies everything that separate() did to the original module \p M, and
  /// maps the values of the analysed copy to it. False if the two are then not
  /// the same program.
  bool bringBack();
  /// After bringBack(): the value of the original module for \p V; null if
  /// there is none (\p V was made by promotion).
  llvm::Value *original(llvm::Value *V) const;
  /// The row of the rules that describes the function that \p Call, of the
  /// original module, calls; null if there is none.
  const Rule *rowOf(const llvm::CallBase &Call) const;

private:
  void prepareCopy();
  bool repeatInCopy(llvm::ArrayRef<SeparatedFunction> Done);
  bool repeatInCopy(const SeparatedFunction &Of);
  bool addHandles(const llvm::Function &From, llvm::ValueToValueMapTy &Map);

  llvm::Module &M;
  const Options &Opts;
  std::shared_ptr<const Rules> Tables;
  Separation Calls;
  /// What bringBack() makes of M: not prepared, and never analysed.
  std::unique_ptr<llvm::Module> Plain;
  std::unique_ptr<llvm::Module> Copy; ///< of Plain, prepared
  bool IsSeparated = false;
  std::vector<std::vector<CopiedFunction>> Copied;
  CallNumbers Numbers; ///< of Plain and Copy
  /// The instructions of Plain as they are in Copy, in the order of Plain. Each
  /// is null or the value that preparing put in its place.
  std::vector<llvm::WeakTrackingVH> Instructions;
  std::vector<unsigned char> Opcodes; ///< of the instructions of Plain
  /// Where the instructions of the functions of Plain begin in these.
  llvm::DenseMap<const llvm::Function *, size_t> Begins;
  llvm::DenseMap<const llvm::Value *, llvm::Value *> Back;
};

/// The functions of the prepared module \p M in which the name of a parameter
/// depends on the call; callers before callees.
std::vector<std::string> namedByCalls(llvm::Module &M,
                                      llvm::ModuleAnalysisManager &AM);

/// `tpc-prepare`: prepares a whole module, for the printers.
class PreparePass : public llvm::PassInfoMixin<PreparePass> {
public:
  llvm::PreservedAnalyses run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);
  static bool isRequired() { return true; }
};

} // namespace tpc

#endif // TPC_PREPARE_H
