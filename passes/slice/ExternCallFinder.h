//===- ExternCallFinder.h - The exposing statements -----------------------===//
//
// Thesis A.8: the calls that make the internal state of a node visible. The
// rules list them; the topic is found if a constant names it.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_EXTERNCALLFINDER_H
#define TPC_EXTERNCALLFINDER_H

#include "Rules.h"

#include "llvm/ADT/SmallVector.h"

namespace tpc {

struct ExposingStatement {
  llvm::CallBase *Call;
  const Rule *Row;
  std::string Topic; ///< empty if no constant names it
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
