//===- SimpleCallGraph.h - Who calls a function ---------------------------===//
//
// Thesis A.5: function -> the call and invoke instructions that call it. Calls
// that name their callee are resolved; the others are counted, and are what a
// class hierarchy and callbacks will be resolved from.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_SIMPLECALLGRAPH_H
#define TPC_SIMPLECALLGRAPH_H

#include "llvm/ADT/MapVector.h"
#include "llvm/ADT/SmallVector.h"
#include "llvm/IR/InstrTypes.h"
#include "llvm/IR/PassManager.h"

namespace tpc {

class RuleMatches;

class CallGraphResult {
public:
  /// The calls of \p F, in the order of the module.
  llvm::ArrayRef<llvm::CallBase *> callers(const llvm::Function *F) const;
  /// The functions that \p Call may enter and that are looked into: they have
  /// a body, and the rules do not stand for it.
  llvm::SmallVector<llvm::Function *, 1>
  callees(const llvm::CallBase &Call) const;

  unsigned IndirectCalls = 0; ///< calls whose callee is not known

private:
  friend class SimpleCallGraph;
  friend class SimpleCallGraphPrinter;
  const RuleMatches *Rules = nullptr;
  llvm::MapVector<const llvm::Function *,
                  llvm::SmallVector<llvm::CallBase *, 4>>
      Callers;
};

class SimpleCallGraph : public llvm::AnalysisInfoMixin<SimpleCallGraph> {
public:
  using Result = CallGraphResult;
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);

private:
  friend llvm::AnalysisInfoMixin<SimpleCallGraph>;
  static llvm::AnalysisKey Key;
};

/// `print<tpc-callgraph>`
class SimpleCallGraphPrinter
    : public llvm::PassInfoMixin<SimpleCallGraphPrinter> {
public:
  explicit SimpleCallGraphPrinter(llvm::raw_ostream &OS) : OS(OS) {}
  llvm::PreservedAnalyses run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);
  static bool isRequired() { return true; }

private:
  llvm::raw_ostream &OS;
};

} // namespace tpc

#endif // TPC_SIMPLECALLGRAPH_H
