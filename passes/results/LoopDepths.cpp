//===- LoopDepths.cpp -----------------------------------------------------===//
#include "results/LoopDepths.h"

#include "Options.h"
#include "calls/SimpleCallGraph.h"
#include "results/GatherResults.h"
#include "support/Budget.h"
#include "support/Functions.h"
#include "support/Names.h"
#include "support/Print.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/Analysis/LoopInfo.h"
#include "llvm/Support/CommandLine.h"

#include <optional>

using namespace llvm;

namespace tpc {

AnalysisKey LoopDepths::Key;

/// A call of an algorithm of the standard library takes about five.
static cl::opt<unsigned>
    MaxCalls("tpc-max-loop-calls", cl::Hidden, cl::init(6),
             cl::desc("Calls that are followed upwards to find loops"));

namespace {

class Finder {
public:
  Finder(Module &M, ModuleAnalysisManager &AM)
      : Calls(AM.getResult<SimpleCallGraph>(M)),
        Sources(AM.getResult<OptionsAnalysis>(M)),
        Functions(
            AM.getResult<FunctionAnalysisManagerModuleProxy>(M).getManager()) {
    findWaiting(M);
  }

  unsigned depthOf(const Instruction &I) {
    return loopsAround(I) + around(*I.getFunction(), MaxCalls).value_or(0);
  }

private:
  void findWaiting(Module &M);
  unsigned loopsAround(const Instruction &I);
  bool waits(const Loop &L);
  std::optional<unsigned> around(const Function &F, unsigned Most);

  const CallGraphResult &Calls;
  UserSources Sources;
  FunctionAnalysisManager &Functions;
  /// The functions that wait, and those that call one of them by name.
  SmallPtrSet<const Function *, 32> Waiting;
  DenseMap<const Loop *, bool> Waits;
  DenseMap<std::pair<const Function *, unsigned>, std::optional<unsigned>>
      Known;
};

} // namespace

void Finder::findWaiting(Module &M) {
  SmallVector<const Function *, 32> Work;
  for (const Function &F : M)
    if (F.isDeclaration() && waitsByName(F))
      Work.push_back(&F);
  Waiting.insert(Work.begin(), Work.end());
  while (!Work.empty())
    for (const User *U : Work.pop_back_val()->users())
      if (const auto *Call = dyn_cast<CallBase>(U);
          Call && Waiting.contains(Call->getCalledFunction()) &&
          Waiting.insert(Call->getFunction()).second)
        Work.push_back(Call->getFunction());
}

bool Finder::waits(const Loop &L) {
  auto [It, New] = Waits.try_emplace(&L, false);
  if (New)
    It->second = any_of(L.blocks(), [&](const BasicBlock *BB) {
      return any_of(*BB, [&](const Instruction &I) {
        const auto *Call = dyn_cast<CallBase>(&I);
        return Call && Waiting.contains(Call->getCalledFunction());
      });
    });
  return It->second;
}

unsigned Finder::loopsAround(const Instruction &I) {
  // LoopAnalysis changes nothing; the manager takes functions that it may.
  auto &F = const_cast<Function &>(*I.getFunction());
  const LoopInfo &Loops = Functions.getResult<LoopAnalysis>(F);
  unsigned Depth = 0;
  for (const Loop *L = Loops.getLoopFor(I.getParent()); L;
       L = L->getParentLoop())
    Depth += !waits(*L);
  return Depth;
}

/// The most loops around a call of \p F, at most \p Most calls up; none if \p F
/// is library code that no user code calls.
std::optional<unsigned> Finder::around(const Function &F, unsigned Most) {
  auto [It, New] = Known.try_emplace({&F, Most});
  if (!New)
    return It->second;
  std::optional<unsigned> Found;
  if (Sources.has(F))
    Found = 0;
  if (Most > 0)
    for (const CallBase *Call : Calls.callers(&F)) {
      if (Call->getFunction() == &F || Budget::isSpent())
        continue;
      if (auto Further = around(*Call->getFunction(), Most - 1))
        Found = std::max(Found.value_or(0), loopsAround(*Call) + *Further);
    }
  return Known[{&F, Most}] = Found;
}

LoopDepthsResult LoopDepths::run(Module &M, ModuleAnalysisManager &AM) {
  const GatheredResults &Gathered = AM.getResult<GatherResults>(M);
  LoopDepthsResult R;
  if (Gathered.Comparisons.empty() && Gathered.Constants.empty())
    return R;
  Finder Found(M, AM);
  for (const auto *Kind : {&Gathered.Comparisons, &Gathered.Constants})
    for (const Comparison &C : *Kind)
      if (unsigned Depth = Found.depthOf(C.place()))
        R.Depths[&C.place()] = Depth;
  return R;
}

unsigned LoopDepthsResult::of(const Comparison &C) const {
  return Depths.lookup(&C.place());
}

PreservedAnalyses LoopDepthsPrinter::run(Module &M, ModuleAnalysisManager &AM) {
  const LoopDepthsResult &R = AM.getResult<LoopDepths>(M);
  OS << "loops around comparisons of " << M.getName() << '\n';
  for (const Comparison &C : AM.getResult<GatherResults>(M).Comparisons)
    OS << "  " << R.of(C) << place(C.place()) << '\n';
  return PreservedAnalyses::all();
}

} // namespace tpc
