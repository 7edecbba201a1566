//===- ExternCallFinder.h - The exposing statements -----------------------===//
//
// Thesis A.8: the calls that make the internal state of a node visible. The
// rules list them; the topic is found if a constant names it. Beyond the
// thesis, the results and arguments of functions that override those of another
// library (see Overriding.h).
//
//===----------------------------------------------------------------------===//
#ifndef TPC_EXTERNCALLFINDER_H
#define TPC_EXTERNCALLFINDER_H

#include "Rules.h"

#include "llvm/ADT/SmallVector.h"
#include "llvm/IR/Instructions.h"

namespace tpc {

struct ExposingStatement {
  /// The call; for an overriding function, a return; for the inherited part of
  /// an object, what writes to it.
  llvm::Instruction *At;
  std::string Api;   ///< the function, with scopes
  std::string Topic; ///< empty if no constant names it
  /// What an overriding function writes; null if it is the result.
  const llvm::Argument *Written = nullptr;

  /// The call of a function that the rules list.
  bool IsCall = false;
};

class ExternCallFinder : public llvm::AnalysisInfoMixin<ExternCallFinder> {
public:
  /// In the order of the module.
  using Result = llvm::SmallVector<ExposingStatement, 0>;
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);

private:
  friend llvm::AnalysisInfoMixin<ExternCallFinder>;
  static llvm::AnalysisKey Key;
};

/// `print<tpc-extern-calls>`
class ExternCallFinderPrinter
    : public llvm::PassInfoMixin<ExternCallFinderPrinter> {
public:
  explicit ExternCallFinderPrinter(llvm::raw_ostream &OS) : OS(OS) {}
  llvm::PreservedAnalyses run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);
  static bool isRequired() { return true; }

private:
  llvm::raw_ostream &OS;
};

} // namespace tpc

#endif // TPC_EXTERNCALLFINDER_H
