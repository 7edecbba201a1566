//===- Prepare.h - The program as it is analysed --------------------------===//
//
// The analysis wants local variables as SSA values, and small functions of
// libraries (a message's accessors, std::max, a smart pointer's arrow) inside
// their callers, so that each use of them stands for itself. That is done to a
// copy, and what is found is carried back: what the user gets is the program as
// the compiler would have made it without us, at every level. The findings are
// the same at every level, too.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_PREPARE_H
#define TPC_PREPARE_H

#include "llvm/ADT/DenseMap.h"
#include "llvm/IR/Instruction.h"
#include "llvm/IR/Module.h"
#include "llvm/IR/PassManager.h"
#include "llvm/IR/ValueHandle.h"

#include <memory>

namespace tpc {

struct Options;
class Rules;

/// What is done to a program before reports can be put into it, because a
/// report inside a function stands for all of its calls: functions whose
/// comparisons are their callers' are inlined, and functions whose calls are to
/// be told apart are copied for each of them. Done to two copies of a program
/// it leaves two copies of one.
class Separation {
public:
  /// \p Tables name the functions that are inlined.
  explicit Separation(const Rules &Tables) : Tables(Tables) {}
  /// Has the calls of each function of \p Names told apart, after what was
  /// asked for before.
  void add(std::vector<std::string> Names) {
    Rounds.push_back(std::move(Names));
  }
  void removeLast() { Rounds.pop_back(); }

  /// What applyTo did.
  struct Effect {
    bool Any = false;
    bool LastRound = false; ///< what was asked for last did something
  };
  Effect applyTo(llvm::Module &M) const;

private:
  const Rules &Tables;
  std::vector<std::vector<std::string>> Rounds;
};

/// The module to analyse for a module to instrument, which stays as it is.
class AnalysedModule {
public:
  AnalysedModule(llvm::Module &M, const Options &Opts,
                 std::shared_ptr<const Rules> Tables);

  llvm::Module &module() { return *Copy; }

  /// Starts anew with the calls of each of \p Names told apart. False, and
  /// nothing has changed, where there are none that can be.
  bool separate(std::vector<std::string> Names);

  /// True where bringBack() changes the module that was copied.
  bool isSeparated() const { return IsSeparated; }
  /// Does to \p M, the module that was copied, what separate() asked for, and
  /// finds the counterparts of the values of the analysed module there. False
  /// where that is not the same program.
  bool bringBack();
  /// After bringBack(): what \p V of the analysed module is in the original;
  /// null where it is nothing there (a value that promotion made).
  llvm::Value *original(llvm::Value *V) const;

private:
  /// True where what was asked for last did something.
  bool copy();
  void prepareCopy();

  llvm::Module &M;
  const Options &Opts;
  std::shared_ptr<const Rules> Tables;
  Separation Calls;
  std::unique_ptr<llvm::Module> Copy;
  bool IsSeparated = false;
  /// The instructions of Copy as it was before it was prepared, in their order;
  /// what promotion replaced them with, or null.
  std::vector<llvm::WeakTrackingVH> Instructions;
  std::vector<unsigned char> Opcodes; ///< of these, as they were
  llvm::DenseMap<const llvm::Value *, llvm::Value *> Back;
};

/// The functions of \p M, a prepared module, in which the name of a parameter
/// depends on the call; callers before callees.
std::vector<std::string> namedByCalls(llvm::Module &M,
                                      llvm::ModuleAnalysisManager &AM);

/// `tpc-prepare`: the same to a whole module, for the printers.
class PreparePass : public llvm::PassInfoMixin<PreparePass> {
public:
  llvm::PreservedAnalyses run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);
  static bool isRequired() { return true; }
};

} // namespace tpc

#endif // TPC_PREPARE_H
