//===- SimpleCallGraph.cpp ------------------------------------------------===//
#include "SimpleCallGraph.h"

#include "Functions.h"
#include "Print.h"
#include "Rules.h"

#include "llvm/IR/InstIterator.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

AnalysisKey SimpleCallGraph::Key;

ArrayRef<CallBase *> CallGraphResult::callers(const Function *F) const {
  auto It = Callers.find(F);
  return It == Callers.end() ? ArrayRef<CallBase *>() : ArrayRef(It->second);
}

SmallVector<Function *, 1>
CallGraphResult::callees(const CallBase &Call) const {
  Function *F = Call.getCalledFunction();
  if (!F || F->isDeclarationForLinker() || Rules->isOpaque(*F))
    return {};
  return {F};
}

CallGraphResult SimpleCallGraph::run(Module &M, ModuleAnalysisManager &AM) {
  CallGraphResult R;
  R.Rules = &AM.getResult<RuleAnalysis>(M);
  for (Function &F : M)
    R.Callers[&F];
  for (Function &F : definedFunctions(M))
    for (Instruction &I : instructions(F)) {
      auto *Call = dyn_cast<CallBase>(&I);
      if (!Call || Call->isInlineAsm() || isa<IntrinsicInst>(Call))
        continue;
      if (Function *Callee = Call->getCalledFunction())
        R.Callers[Callee].push_back(Call);
      else
        ++R.IndirectCalls;
    }
  return R;
}

PreservedAnalyses SimpleCallGraphPrinter::run(Module &M,
                                              ModuleAnalysisManager &AM) {
  const CallGraphResult &R = AM.getResult<SimpleCallGraph>(M);
  OS << "call graph of " << M.getName() << '\n';
  for (const auto &[F, Calls] : R.Callers) {
    if (Calls.empty())
      continue;
    OS << "  " << F->getName() << " is called\n";
    for (const CallBase *Call : Calls)
      OS << "    in " << Call->getFunction()->getName() << place(*Call) << '\n';
  }
  OS << "  indirect calls: " << R.IndirectCalls << '\n';
  return PreservedAnalyses::all();
}

} // namespace tpc
