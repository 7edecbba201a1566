//===- IfStatements.cpp ---------------------------------------------------===//
#include "IfStatements.h"

#include "Budget.h"
#include "ControlDependence.h"
#include "Functions.h"
#include "Options.h"
#include "Print.h"

#include "llvm/IR/CFG.h"
#include "llvm/IR/InstIterator.h"
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
  // A select's condition is its first operand, a branch's its last, and a
  // switch's its first again; only the branch has to be asked.
  if (const auto *Br = dyn_cast<BranchInst>(&Predicate))
    return Br->getCondition();
  assert(isPredicate(Predicate) && "decides nothing");
  return Predicate.getOperand(0);
}

ArrayRef<Instruction *>
IfStatementsResult::controllers(const BasicBlock *BB) const {
  auto It = Controllers.find(BB);
  return It == Controllers.end() ? ArrayRef<Instruction *>()
                                 : ArrayRef(It->second);
}

/// True where \p BB does more than to choose the way.
static bool doesSomething(const BasicBlock &BB) {
  return any_of(BB, [](const Instruction &I) {
    return I.mayHaveSideEffects() && !I.isLifetimeStartOrEnd();
  });
}

/// Merged values that are constant on one way through the program.
using KnownMerges = SmallDenseMap<const PHINode *, const ConstantInt *, 4>;

/// Adds to \p Known what the merges of \p BB are where it is entered from
/// \p From.
static void enterBlock(const BasicBlock *From, const BasicBlock &BB,
                       KnownMerges &Known) {
  SmallVector<std::pair<const PHINode *, const ConstantInt *>, 4> Now;
  for (const PHINode &Phi : BB.phis()) {
    const Value *In = Phi.getIncomingValueForBlock(From);
    const auto *Merge = dyn_cast<PHINode>(In);
    Now.emplace_back(&Phi,
                     Merge ? Known.lookup(Merge) : dyn_cast<ConstantInt>(In));
  }
  for (const auto &[Phi, C] : Now)
    Known[Phi] = C;
}

/// Where \p T surely goes on to; null where that is open.
static const BasicBlock *surelyNext(const Instruction &T,
                                    const KnownMerges &Known) {
  if (!isPredicate(T))
    return nullptr;
  const Value *Condition = conditionOf(T);
  bool Negated = false;
  while (const auto *I = dyn_cast<Instruction>(Condition)) {
    if (I->getOpcode() == Instruction::Xor && I->getType()->isIntegerTy(1) &&
        isa<ConstantInt>(I->getOperand(1)))
      Negated ^= cast<ConstantInt>(I->getOperand(1))->isOne();
    else if (!isa<CastInst>(I))
      break;
    Condition = I->getOperand(0);
  }
  const auto *Phi = dyn_cast<PHINode>(Condition);
  const ConstantInt *C = Phi ? Known.lookup(Phi) : nullptr;
  if (!C)
    return nullptr;
  if (const auto *Br = dyn_cast<BranchInst>(&T))
    return Br->getSuccessor(C->isZero() == Negated ? 0 : 1);
  const auto *Switch = cast<SwitchInst>(&T);
  for (auto Case : Switch->cases())
    if (Case.getCaseValue()->getValue() ==
        C->getValue().zextOrTrunc(Case.getCaseValue()->getBitWidth()))
      return Case.getCaseSuccessor();
  return Switch->getDefaultDest();
}

const BasicBlock *decidedWay(const BasicBlock *From, const BasicBlock *BB,
                             SmallPtrSetImpl<const BasicBlock *> *Passed) {
  KnownMerges Known;
  SmallPtrSet<const BasicBlock *, 4> Seen;
  const BasicBlock *End = nullptr;
  while (Seen.insert(BB).second) {
    enterBlock(From, *BB, Known);
    const BasicBlock *Next = surelyNext(*BB->getTerminator(), Known);
    if (!Next)
      break;
    if (Passed)
      Passed->insert(BB);
    From = std::exchange(BB, Next);
    End = Next;
  }
  return End;
}

/// True where the program ends soon after \p BB, or leaves by an exception,
/// whatever happens: what an assertion does that does not hold.
static bool endsProgram(const BasicBlock *BB) {
  for (unsigned Steps = 0; Steps < 8 && BB; ++Steps) {
    const Instruction *T = BB->getTerminator();
    if (isa<UnreachableInst>(T))
      return true;
    if (const auto *Invoke = dyn_cast<InvokeInst>(T))
      BB = Invoke->getNormalDest();
    else
      BB = BB->getUniqueSuccessor();
  }
  return false;
}

/// The flow graph of \p F without the edges that exceptions take, and with
/// the two nodes of Ferrante et al. behind the blocks: the entry, from which
/// the function is either entered or not, and the end of not entering it.
///
/// Checks of libraries (that a pointer is not null, that a function is there)
/// that end the program are left out as exceptions are: nobody who reads the
/// source sees them.
///
/// With \p Passed, an edge into a block that is decided by the edge goes on
/// to where the block then leads, and the block is put in there.
static FlowGraph flowGraphOf(const Function &F,
                             const DenseMap<const BasicBlock *, unsigned> &Id,
                             SmallPtrSetImpl<const BasicBlock *> *Passed,
                             UserSources &Sources) {
  FlowGraph Graph(F.size() + 2);
  Graph[F.size()] = {Id.lookup(&F.getEntryBlock()),
                     static_cast<unsigned>(F.size()) + 1};
  for (const BasicBlock &BB : F) {
    std::vector<unsigned> &Succs = Graph[Id.lookup(&BB)];
    if (const auto *Invoke = dyn_cast<InvokeInst>(BB.getTerminator())) {
      Succs.push_back(Id.lookup(Invoke->getNormalDest()));
      continue;
    }
    const Instruction *T = BB.getTerminator();
    bool Library = T->getNumSuccessors() == 2 && T->getDebugLoc() &&
                   !Sources.has(T->getDebugLoc());
    for (const BasicBlock *Succ : successors(&BB)) {
      if (Library && endsProgram(Succ) &&
          !endsProgram(T->getSuccessor(Succ == T->getSuccessor(0) ? 1 : 0)))
        continue;
      const BasicBlock *On = Passed ? decidedWay(&BB, Succ, Passed) : nullptr;
      Succs.push_back(Id.lookup(On ? On : Succ));
    }
  }
  return Graph;
}

/// Takes the ways out of the blocks that all edges of \p Threaded were led
/// past: there is nothing that they decide. Blocks that no edge of \p Plain
/// leads to stay, an exception does.
static std::vector<bool> leaveOutBypassed(const FlowGraph &Plain,
                                          FlowGraph &Threaded) {
  std::vector<bool> Entered(Plain.size()), Reached(Plain.size());
  for (const std::vector<unsigned> &Succs : Plain)
    for (unsigned S : Succs)
      Entered[S] = true;
  std::vector<unsigned> Work;
  for (unsigned N = 0; N < Plain.size(); ++N)
    if (!Entered[N])
      Work.push_back(N);
  while (!Work.empty()) {
    unsigned N = Work.back();
    Work.pop_back();
    if (Reached[N])
      continue;
    Reached[N] = true;
    Work.insert(Work.end(), Threaded[N].begin(), Threaded[N].end());
  }
  for (unsigned N = 0; N < Plain.size(); ++N)
    if (!Reached[N])
      Threaded[N].clear();
  return Reached;
}

IfStatementsResult IfStatements::run(Module &M, ModuleAnalysisManager &) {
  IfStatementsResult R;
  const Options Opts = Options::fromCommandLine();
  UserSources Sources(Opts);
  for (Function &F : definedFunctions(M)) {
    if (Budget::isSpent())
      break;
    for (Instruction &I : instructions(F))
      if (isPredicate(I))
        R.Predicates.push_back(&I);
    DenseMap<const BasicBlock *, unsigned> Id;
    SmallVector<BasicBlock *, 32> Blocks;
    for (BasicBlock &BB : F) {
      Id[&BB] = Blocks.size();
      Blocks.push_back(&BB);
    }
    SmallPtrSet<const BasicBlock *, 8> Passed;
    FlowGraph Plain = flowGraphOf(F, Id, /*Passed=*/nullptr, Sources);
    FlowGraph Threaded = flowGraphOf(F, Id, &Passed, Sources);
    std::vector<bool> Reached = leaveOutBypassed(Plain, Threaded);
    auto Depends = controlDependence(Threaded);
    if (Plain != Threaded) {
      // What a block does that edges were led past is done on all of them;
      // one that does nothing is only the end of a condition.
      auto Before = controlDependence(Plain);
      for (unsigned N = 0; N < Blocks.size(); ++N)
        if (!Reached[N] ||
            (doesSomething(*Blocks[N]) && Passed.contains(Blocks[N])))
          Depends[N] = Before[N];
    }
    for (unsigned N = 0; N < Blocks.size(); ++N) {
      SmallVector<Instruction *, 2> Controllers;
      bool ByEntry = Depends[N].empty();
      for (unsigned Branch : Depends[N])
        if (Branch >= Blocks.size())
          ByEntry = true;
        else if (Instruction *T = Blocks[Branch]->getTerminator();
                 isPredicate(*T))
          Controllers.push_back(T);
      if (!Controllers.empty())
        R.Controllers[Blocks[N]] = std::move(Controllers);
      if (ByEntry)
        R.ByEntry.insert(Blocks[N]);
    }
  }
  return R;
}

PreservedAnalyses IfStatementsPrinter::run(Module &M,
                                           ModuleAnalysisManager &AM) {
  const IfStatementsResult &R = AM.getResult<IfStatements>(M);
  OS << "predicates of " << M.getName() << ": " << R.predicates().size()
     << '\n';
  for (const Function &F : M)
    for (const BasicBlock &BB : F) {
      OS << "  " << F.getName() << ' ';
      BB.printAsOperand(OS, false);
      OS << " controlled by";
      if (R.isControlledByEntry(&BB))
        OS << " entry";
      for (const Instruction *P : R.controllers(&BB)) {
        OS << ' ';
        P->getParent()->printAsOperand(OS, false);
        OS << place(*P);
      }
      OS << '\n';
    }
  return PreservedAnalyses::all();
}

} // namespace tpc
