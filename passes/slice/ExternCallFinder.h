//===- ExternCallFinder.h - The exposing statements -----------------------===//
//
// Thesis A.8: the calls through which a node's inner state becomes visible.
// Found by the rules; the topic is looked up where a constant names it.
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
  std::string Topic; ///< empty where no constant names it
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
