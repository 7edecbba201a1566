//===- SimpleCallGraph.cpp ------------------------------------------------===//
#include "calls/SimpleCallGraph.h"

#include "Options.h"
#include "Rules.h"
#include "calls/ClassHierarchy.h"
#include "calls/FunctionPointers.h"
#include "support/Functions.h"
#include "support/Names.h"
#include "support/Print.h"

#include "llvm/ADT/Statistic.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Module.h"
#include "llvm/Support/CommandLine.h"
#include "llvm/Support/Debug.h"

using namespace llvm;

namespace tpc {

#define DEBUG_TYPE "tpc-callgraph"
STATISTIC(NumIndirect, "Indirect calls");
STATISTIC(NumUnresolved, "Indirect calls whose targets are not known");

AnalysisKey SimpleCallGraph::Key;

ArrayRef<CallBase *> CallGraphResult::callers(const Function *F) const {
  const auto *It = Callers.find(F);
  return It == Callers.end() ? ArrayRef<CallBase *>() : ArrayRef(It->second);
}

ArrayRef<Instruction *> CallGraphResult::mentions(const Function *F) const {
  const auto *It = Mentions.find(F);
  return It == Mentions.end() ? ArrayRef<Instruction *>()
                              : ArrayRef(It->second);
}

bool CallGraphResult::allCallsKnown(const Function &F) const {
  return !F.hasAddressTaken() ||
         (!HandedOn.contains(&F) &&
          !UnresolvedTypes.contains(F.getFunctionType()));
}

SmallVector<Function *, 1>
CallGraphResult::callees(const CallBase &Call) const {
  SmallVector<Function *, 1> Found;
  auto Add = [&](Function *F) {
    if (!F->isDeclarationForLinker() && !Rules->isOpaque(*F))
      Found.push_back(F);
  };
  if (Function *F = Call.getCalledFunction())
    Add(F);
  else if (auto It = Indirect.find(&Call); It != Indirect.end())
    for_each(It->second, Add);
  return Found;
}

bool CallGraphResult::onlyDestroys(const CallBase &Call) const {
  if (const Function *F = Call.getCalledFunction())
    return endsLife(Call) || isDestructor(F->getName());
  for (const DILocation *At = Call.getDebugLoc(); At; At = At->getInlinedAt())
    if (Rules->isDestroying(*At->getScope()->getSubprogram()))
      return true;
  auto It = Indirect.find(&Call);
  return It != Indirect.end() && !It->second.empty() &&
         all_of(It->second,
                [](const Function *F) { return isDestructor(F->getName()); });
}

/// Trampolines are shallow. A larger function does not count as one.
static cl::opt<unsigned> MaxCallees(
    "tpc-max-library-callees", cl::Hidden, cl::init(64),
    cl::desc("Library functions that are searched for an indirect call"));

/// True if the library function \p F calls a target that only its data
/// contains, like the result of boost::bind for a pointer to a member. All
/// callbacks with the same signature share such a function.
static bool callsAnything(const Function &F, UserSources &Sources) {
  SmallSetVector<const Function *, 8> Work;
  Work.insert(&F);
  for (unsigned N = 0; N < Work.size() && N < MaxCallees; ++N)
    for (const Instruction &I : instructions(*Work[N])) {
      const auto *Call = dyn_cast<CallBase>(&I);
      if (!Call || Call->isInlineAsm())
        continue;
      const Function *Callee = Call->getCalledFunction();
      if (!Callee)
        return true;
      if (!Callee->isDeclaration() && !Sources.has(*Callee))
        Work.insert(Callee);
    }
  return false;
}

/// Calls \p Add with the instructions that use \p C, also those that use it as
/// a part of another constant.
template <typename Fn> static void forEachUser(Constant &C, Fn Add) {
  SmallVector<Constant *, 4> Work{&C};
  while (!Work.empty())
    for (Use &U : Work.pop_back_val()->uses()) {
      if (auto *I = dyn_cast<Instruction>(U.getUser()))
        Add(*I, U);
      else if (auto *Outer = dyn_cast<Constant>(U.getUser());
               Outer && !isa<GlobalValue>(Outer))
        Work.push_back(Outer);
    }
}

void CallGraphResult::findMentions(Module &M, const Options &Opts) {
  UserSources Sources(Opts);
  // The order of a use list is arbitrary, and constants may also be used in
  // functions that have been removed from the module.
  DenseMap<const Instruction *, unsigned> Order;
  for (Function &F : definedFunctions(M)) {
    if (Rules->isOpaque(F) || !F.hasAddressTaken())
      continue;
    SmallSetVector<Instruction *, 4> Found;
    forEachUser(F, [&](Instruction &I, const Use &U) {
      auto *Call = dyn_cast<CallBase>(&I);
      if (I.getModule() == &M && !(Call && Call->isCallee(&U)))
        Found.insert(&I);
    });
    if (!Found.empty())
      HandedOn.insert(&F);
    if (Found.empty() || (!Sources.has(F) && callsAnything(F, Sources)))
      continue;
    Mentions[&F] = Found.takeVector();
    for (const Instruction *I : Mentions[&F])
      Order[I] = 0;
  }
  if (Order.empty())
    return;
  unsigned Next = 0;
  for (Function &F : M)
    for (Instruction &I : instructions(F))
      if (auto It = Order.find(&I); It != Order.end())
        It->second = ++Next;
  for (auto &[F, List] : Mentions)
    sort(List, [&](const Instruction *A, const Instruction *B) {
      return Order.lookup(A) < Order.lookup(B);
    });
}

/// Drops the calls that opaque functions make to a library: their arguments are
/// not uses of what the caller passed.
void CallGraphResult::forgetOpaqueCallers(const Options &Opts) {
  UserSources Sources(Opts);
  for (auto &[F, Calls] : Callers)
    if (!Sources.has(*F))
      erase_if(Calls, [&](const CallBase *Call) {
        return Rules->isOpaque(*Call->getFunction());
      });
}

CallGraphResult SimpleCallGraph::run(Module &M, ModuleAnalysisManager &AM) {
  CallGraphResult R;
  R.Rules = &AM.getResult<RuleAnalysis>(M);
  for (Function &F : M)
    R.Callers[&F];
  SmallVector<CallBase *, 0> ThroughPointers;
  std::optional<ClassHierarchy> Classes;
  auto Resolve = [&](CallBase &Call, ArrayRef<Function *> Targets) {
    for (Function *F : Targets)
      R.Callers[F].push_back(&Call);
    R.Indirect[&Call].assign(Targets.begin(), Targets.end());
  };
  for (Function &F : definedFunctions(M))
    for (Instruction &I : instructions(F)) {
      auto *Call = dyn_cast<CallBase>(&I);
      if (!Call || Call->isInlineAsm() || isa<IntrinsicInst>(Call))
        continue;
      if (Function *Callee = Call->getCalledFunction()) {
        R.Callers[Callee].push_back(Call);
        continue;
      }
      std::optional<VirtualCall> How = ClassHierarchy::match(*Call);
      if (!How) {
        ThroughPointers.push_back(Call);
        continue;
      }
      if (!Classes)
        Classes.emplace(M);
      if (auto Targets = Classes->targets(*Call, *How); !Targets.empty())
        Resolve(*Call, Targets);
      else
        R.Unresolved.push_back(Call);
    }
  if (!ThroughPointers.empty()) {
    FunctionPointers Pointers(M);
    auto Callers = [&](const Function *F) { return R.callers(F); };
    // A resolved call passes on pointers that other calls may call.
    for (unsigned Round = 0; Round < 2; ++Round)
      for (CallBase *Call : ThroughPointers)
        if (!R.Indirect.contains(Call))
          if (auto Targets = Pointers.targets(*Call, Callers); !Targets.empty())
            Resolve(*Call, Targets);
    for (CallBase *Call : ThroughPointers)
      if (!R.Indirect.contains(Call))
        R.Unresolved.push_back(Call);
  }
  for (const CallBase *Call : R.Unresolved) {
    LLVM_DEBUG(dbgs() << "unresolved: " << *Call << '\n');
    R.UnresolvedTypes.insert(Call->getFunctionType());
  }
  NumIndirect += R.Indirect.size() + R.Unresolved.size();
  NumUnresolved += R.Unresolved.size();
  const Options &Opts = AM.getResult<OptionsAnalysis>(M);
  R.forgetOpaqueCallers(Opts);
  R.findMentions(M, Opts);
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
  for (const Function &F : M) {
    ArrayRef<Instruction *> Mentions = R.mentions(&F);
    if (Mentions.empty())
      continue;
    OS << "  " << F.getName() << " is mentioned\n";
    for (const Instruction *I : Mentions)
      OS << "    in " << I->getFunction()->getName() << place(*I) << '\n';
  }
  OS << "  indirect calls: " << R.unresolved().size() << '\n';
  for (const CallBase *Call : R.unresolved())
    OS << "    in " << Call->getFunction()->getName() << place(*Call) << '\n';
  return PreservedAnalyses::all();
}

} // namespace tpc
