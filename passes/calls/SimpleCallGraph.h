//===- SimpleCallGraph.h - Who calls a function ---------------------------===//
//
// Thesis A.5: function -> the call and invoke instructions that call it: those
// that name it, virtual calls by the class hierarchy, and calls through
// pointers by where the pointers come from. A function that is handed to
// somebody else to be called (a subscriber's callback, a thread's, a timer's)
// has the places that mention it; it runs only if they do.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_SIMPLECALLGRAPH_H
#define TPC_SIMPLECALLGRAPH_H

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/DenseSet.h"
#include "llvm/ADT/MapVector.h"
#include "llvm/ADT/SmallVector.h"
#include "llvm/IR/InstrTypes.h"
#include "llvm/IR/PassManager.h"

namespace tpc {

struct Options;
class RuleMatches;

class CallGraphResult {
public:
  /// The calls of \p F, in the order of the module; for a library's function
  /// without those by functions that are not looked into.
  llvm::ArrayRef<llvm::CallBase *> callers(const llvm::Function *F) const;
  /// The functions that \p Call may enter and that are looked into: they have
  /// a body, and the rules do not stand for it.
  llvm::SmallVector<llvm::Function *, 1>
  callees(const llvm::CallBase &Call) const;

  /// The instructions that hand on the address of \p F, in the order of the
  /// module.
  llvm::ArrayRef<llvm::Instruction *> mentions(const llvm::Function *F) const;

  /// True where \p F is called from nowhere but from its callers, as far as
  /// this module goes.
  bool allCallsKnown(const llvm::Function &F) const;

  /// Calls whose callee is not known, in the order of the module.
  llvm::ArrayRef<llvm::CallBase *> unresolved() const { return Unresolved; }

private:
  friend class SimpleCallGraph;
  friend class SimpleCallGraphPrinter;
  void forgetOpaqueCallers(const Options &Opts);
  void findMentions(llvm::Module &M, const Options &Opts);
  const RuleMatches *Rules = nullptr;
  llvm::DenseMap<const llvm::CallBase *, llvm::SmallVector<llvm::Function *, 2>>
      Indirect;
  llvm::MapVector<const llvm::Function *,
                  llvm::SmallVector<llvm::Instruction *, 2>>
      Mentions;
  /// Functions whose address an instruction hands on.
  llvm::DenseSet<const llvm::Function *> HandedOn;
  llvm::SmallVector<llvm::CallBase *, 0> Unresolved;
  llvm::DenseSet<const llvm::FunctionType *> UnresolvedTypes;
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
