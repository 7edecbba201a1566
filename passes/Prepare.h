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

#include <memory>

namespace tpc {

struct Options;

/// The module to analyse for a module to instrument.
class AnalysedModule {
public:
  AnalysedModule(llvm::Module &M, const Options &Opts);

  llvm::Module &module() { return *Copy; }
  /// What \p V of the analysed module is in the original; null where it is
  /// nothing there (a value that promotion made).
  llvm::Value *original(llvm::Value *V) const;

private:
  std::unique_ptr<llvm::Module> Copy;
  llvm::DenseMap<const llvm::Value *, llvm::Value *> Back;
};

/// Gives each call of a function of \p Names in \p M a copy of the function, so
/// that what one call hands it is not taken for what another does. True where
/// something was copied.
bool separateCalls(llvm::Module &M, llvm::ArrayRef<std::string> Names);

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
