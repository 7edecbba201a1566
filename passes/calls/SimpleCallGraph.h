//===- SimpleCallGraph.h - Who calls a function ---------------------------===//
//
// Thesis A.5: function -> the call and invoke instructions that call it. These
// are calls by name, virtual calls (resolved by class hierarchy analysis) and
// calls through pointers (resolved by where the pointers come from). For a
// function whose address is passed on so that other code calls it (the callback
// of a subscriber, thread or timer), the places that mention it are recorded:
// it runs only if they run.
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
  /// The calls of \p F, in the order of the module. For a library function,
  /// calls by opaque functions are left out.
  llvm::ArrayRef<llvm::CallBase *> callers(const llvm::Function *F) const;
  /// The functions that \p Call may enter and whose bodies are analysed.
  llvm::SmallVector<llvm::Function *, 1>
  callees(const llvm::CallBase &Call) const;

  /// True if all that \p Call enters are destructors, or a function without a
  /// body that ends the life of its argument: nobody reads what is written
  /// there.
  bool onlyDestroys(const llvm::CallBase &Call) const;

  /// The instructions that pass on the address of \p F, in the order of the
  /// module.
  llvm::ArrayRef<llvm::Instruction *> mentions(const llvm::Function *F) const;

  /// True if, as far as this module shows, \p F is only called by callers().
  bool allCallsKnown(const llvm::Function &F) const;

  /// Calls with an unknown callee, in the order of the module.
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
  /// Functions whose address an instruction passes on.
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
