//===- IfStatements.cpp ---------------------------------------------------===//
#include "control/IfStatements.h"

#include "Options.h"
#include "control/ControlDependence.h"
#include "control/Flow.h"
#include "control/Throws.h"
#include "support/Budget.h"
#include "support/Functions.h"
#include "support/Print.h"

#include "llvm/IR/CFG.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

AnalysisKey IfStatements::Key;

bool isPredicate(const Instruction &I) {
  if (const auto *Br = dyn_cast<BranchInst>(&I))
    return Br->isConditional();
  if (const auto *Select = dyn_cast<SelectInst>(&I))
    return !Select->getCondition()->getType()->isVectorTy();
  return isa<SwitchInst>(&I);
}

Value *conditionOf(const Instruction &Predicate) {
  // The condition is the first operand of a select and of a switch, but the
  // last operand of a branch.
  if (const auto *Br = dyn_cast<BranchInst>(&Predicate))
    return Br->getCondition();
  assert(isPredicate(Predicate) && "decides nothing");
  return Predicate.getOperand(0);
}

const Value *IfStatementsResult::partOf(const Instruction &I) const {
  const Value *Part = I.getParent();
  if (auto It = Parted.find(I.getParent()); It != Parted.end())
    for (const Instruction *Call : It->second)
      if (Call->comesBefore(&I))
        Part = Call;
  return Part;
}

ArrayRef<Instruction *>
IfStatementsResult::controllersOf(const Value *Part) const {
  auto It = Controllers.find(Part);
  return It == Controllers.end() ? ArrayRef<Instruction *>()
                                 : ArrayRef(It->second);
}

/// True if \p BB does more than choose a successor.
static bool doesSomething(const BasicBlock &BB) {
  return any_of(BB, [](const Instruction &I) {
    const auto *Known = dyn_cast<IntrinsicInst>(&I);
    bool AsksForType =
        Known && Known->getIntrinsicID() == Intrinsic::eh_typeid_for;
    return I.mayHaveSideEffects() && !I.isLifetimeStartOrEnd() && !AsksForType;
  });
}

/// The instructions that decide at the ends of the nodes in \p Depends; some
/// nodes have none.
static SmallVector<Instruction *, 2> decidersIn(ArrayRef<unsigned> Depends,
                                                const Flow &Graphs) {
  SmallVector<Instruction *, 2> Found;
  for (unsigned N : Depends)
    if (N < Graphs.Decider.size() && Graphs.Decider[N] &&
        !is_contained(Found, Graphs.Decider[N]))
      Found.push_back(Graphs.Decider[N]);
  return Found;
}

SmallVector<Instruction *, 4>
IfStatementsResult::choosers(const BasicBlock *From,
                             const BasicBlock *BB) const {
  SmallVector<Instruction *, 4> Found;
  auto It = Decided.find({From, BB});
  if (It != Decided.end())
    append_range(Found, It->second);
  // The other edges are never taken: clang adds one to the end of a scope for
  // the case that none of its successors applies.
  if (Bypassed.contains(From))
    return Found;
  const Instruction *T = From->getTerminator();
  if (isPredicate(*T) || Choosing.contains(T))
    Found.push_back(const_cast<Instruction *>(T));
  append_range(Found, controllers(*T));
  return Found;
}

IfStatementsResult IfStatements::run(Module &M, ModuleAnalysisManager &AM) {
  IfStatementsResult R;
  const auto &Thrown = AM.getResult<Throws>(M);
  const Options &Opts = AM.getResult<OptionsAnalysis>(M);
  UserSources Sources(Opts);
  for (Function &F : definedFunctions(M)) {
    if (Budget::isSpent())
      break;
    for (Instruction &I : instructions(F))
      if (isPredicate(I))
        R.Predicates.push_back(&I);
    Flow Graphs(F, Sources, Thrown);
    ArrayRef<BasicBlock *> Blocks = Graphs.Blocks;
    auto Depends = controlDependence(Graphs.Threaded);
    SmallPtrSet<const BasicBlock *, 8> Passed;
    for (const auto &[N, C] : enumerate(Graphs.Copies)) {
      if (N >= Graphs.NumThrown)
        Passed.insert(C.BB);
      append_range(R.Decided[{C.BB, C.Next}],
                   decidersIn(Depends[C.Node], Graphs));
    }
    if (!Graphs.Copies.empty()) {
      // What a bypassed block does, it does on all of these paths. A block that
      // does nothing is only the end of a condition.
      auto Before = controlDependence(Graphs.Plain);
      for (unsigned N = 0; N < Blocks.size(); ++N) {
        if (!Graphs.Entered[N])
          R.Bypassed.insert(Blocks[N]);
        if (!Graphs.Entered[N] ||
            (doesSomething(*Blocks[N]) && Passed.contains(Blocks[N])))
          Depends[N] = Before[N];
      }
      for (const Flow::Part &P : Graphs.Parts)
        if (!Graphs.Entered[P.Block])
          Depends[P.Node] = Before[P.Node];
      // What happens where an exception passes through happens on its paths
      // too.
      for (const Flow::Copy &C :
           ArrayRef(Graphs.Copies).take_front(Graphs.NumThrown)) {
        unsigned N = Graphs.idOf(C.BB);
        if (Graphs.Entered[N] && !doesSomething(*C.BB))
          continue;
        if (Graphs.Entered[N] && Depends[N].empty())
          Depends[N].push_back(Blocks.size());
        append_range(Depends[N], Depends[C.Node]);
      }
    }
    auto Record = [&](const Value *Part, unsigned N) {
      SmallVector<Instruction *, 2> Controllers =
          decidersIn(Depends[N], Graphs);
      if (!Controllers.empty())
        R.Controllers[Part] = std::move(Controllers);
      if (Depends[N].empty() || is_contained(Depends[N], Blocks.size()))
        R.ByEntry.insert(Part);
    };
    for (unsigned N = 0; N < Blocks.size(); ++N)
      Record(Blocks[N], N);
    for (const Flow::Part &P : Graphs.Parts)
      Record(P.Begin, P.Node);
    for (auto &[BB, Calls] : Graphs.Left)
      R.Parted[BB] = std::move(Calls);
    for (Instruction *I : Graphs.Decider)
      if (isa_and_nonnull<InvokeInst>(I))
        R.Choosing.insert(I);
  }
  return R;
}

PreservedAnalyses IfStatementsPrinter::run(Module &M,
                                           ModuleAnalysisManager &AM) {
  const IfStatementsResult &R = AM.getResult<IfStatements>(M);
  OS << "predicates of " << M.getName() << ": " << R.predicates().size()
     << '\n';
  auto PrintPart = [&](const Value *Part) {
    OS << " controlled by";
    if (R.ByEntry.contains(Part))
      OS << " entry";
    for (const Instruction *P : R.controllersOf(Part)) {
      OS << ' ';
      P->getParent()->printAsOperand(OS, false);
      OS << place(*P);
    }
    OS << '\n';
  };
  for (const Function &F : M)
    for (const BasicBlock &BB : F) {
      OS << "  " << F.getName() << ' ';
      BB.printAsOperand(OS, false);
      PrintPart(&BB);
      for (const Instruction *Call : R.Parted.lookup(&BB)) {
        OS << "    behind the call" << place(*Call);
        PrintPart(Call);
      }
    }
  return PreservedAnalyses::all();
}

} // namespace tpc
