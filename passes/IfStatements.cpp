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

#include <map>

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

/// The blocks from \p BB on that surely follow each other where \p BB is
/// entered from \p From, as far as that is sure. The last one's ways are open;
/// where the first one's are, there is none.
static SmallVector<const BasicBlock *, 4> decidedPath(const BasicBlock *From,
                                                      const BasicBlock *BB) {
  KnownMerges Known;
  SmallVector<const BasicBlock *, 4> Path;
  while (!is_contained(Path, BB)) {
    enterBlock(From, *BB, Known);
    const BasicBlock *Next = surelyNext(*BB->getTerminator(), Known);
    if (!Next)
      break;
    Path.push_back(BB);
    From = std::exchange(BB, Next);
  }
  if (!Path.empty())
    Path.push_back(BB);
  return Path;
}

const BasicBlock *decidedWay(const BasicBlock *From, const BasicBlock *BB) {
  SmallVector<const BasicBlock *, 4> Path = decidedPath(From, BB);
  return Path.empty() ? nullptr : Path.back();
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

namespace {

/// The flow graphs of a function, without the edges that exceptions take, and
/// with the two nodes of Ferrante et al. behind the blocks: the entry, from
/// which the function is either entered or not, and the end of not entering it.
///
/// Checks of libraries (that a pointer is not null, that a function is there)
/// that end the program are left out as exceptions are: nobody who reads the
/// source sees them.
class Flow {
public:
  /// A node for a block as it is on a way that is decided before it is entered.
  struct Copy {
    const BasicBlock *BB, *Next;
    unsigned Node;
  };

  Flow(Function &F, UserSources &Sources);

  /// The blocks, in order; the number of one is that of its node.
  SmallVector<BasicBlock *, 32> Blocks;
  FlowGraph Plain;
  /// Edges into blocks that are decided by the edge lead to copies of them.
  FlowGraph Threaded;
  SmallVector<Copy, 8> Copies;
  /// Blocks that are also entered where their ways are open, or by exceptions.
  std::vector<bool> Entered;

private:
  unsigned copy(ArrayRef<const BasicBlock *> Path);
  void findEntered();

  DenseMap<const BasicBlock *, unsigned> Id;
  std::map<std::vector<unsigned>, unsigned> ByPath;
};

} // namespace

Flow::Flow(Function &F, UserSources &Sources)
    : Plain(F.size() + 2), Threaded(F.size() + 2) {
  for (BasicBlock &BB : F) {
    Id[&BB] = Blocks.size();
    Blocks.push_back(&BB);
  }
  unsigned Size = Blocks.size();
  Plain[Size] = Threaded[Size] = {Id.lookup(&F.getEntryBlock()), Size + 1};
  for (const BasicBlock &BB : F) {
    unsigned N = Id.lookup(&BB);
    const Instruction *T = BB.getTerminator();
    if (const auto *Invoke = dyn_cast<InvokeInst>(T)) {
      Plain[N] = Threaded[N] = {Id.lookup(Invoke->getNormalDest())};
      continue;
    }
    bool Library = T->getNumSuccessors() == 2 && T->getDebugLoc() &&
                   !Sources.has(T->getDebugLoc());
    for (const BasicBlock *Succ : successors(&BB)) {
      if (Library && endsProgram(Succ) &&
          !endsProgram(T->getSuccessor(Succ == T->getSuccessor(0) ? 1 : 0)))
        continue;
      Plain[N].push_back(Id.lookup(Succ));
      SmallVector<const BasicBlock *, 4> Path = decidedPath(&BB, Succ);
      unsigned On = Path.empty() ? Id.lookup(Succ) : copy(Path);
      Threaded[N].push_back(On);
    }
  }
  findEntered();
}

/// The node that stands for the way through \p Path, up to its last block.
unsigned Flow::copy(ArrayRef<const BasicBlock *> Path) {
  if (Path.size() == 1)
    return Id.lookup(Path.front());
  std::vector<unsigned> Key;
  for (const BasicBlock *BB : Path)
    Key.push_back(Id.lookup(BB));
  auto [It, New] = ByPath.try_emplace(Key, Threaded.size());
  unsigned Node = It->second;
  if (New) {
    Threaded.emplace_back();
    Copies.push_back({Path[0], Path[1], Node});
    unsigned Next = copy(Path.drop_front());
    Threaded[Node] = {Next};
  }
  return Node;
}

/// Takes the ways out of the blocks that all edges were led past: there is
/// nothing that they decide. Blocks that no edge leads to stay, an exception
/// does.
void Flow::findEntered() {
  std::vector<bool> HasEdge(Plain.size()), Reached(Threaded.size());
  for (const std::vector<unsigned> &Succs : Plain)
    for (unsigned S : Succs)
      HasEdge[S] = true;
  std::vector<unsigned> Work;
  for (unsigned N = 0; N < Plain.size(); ++N)
    if (!HasEdge[N])
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
  Entered.assign(Reached.begin(), Reached.begin() + Blocks.size());
}

/// What the nodes in \p Depends are as predicates; others of them decide
/// nothing.
static SmallVector<Instruction *, 2>
predicatesIn(ArrayRef<unsigned> Depends, ArrayRef<BasicBlock *> Blocks) {
  SmallVector<Instruction *, 2> Found;
  for (unsigned N : Depends)
    if (N < Blocks.size() && isPredicate(*Blocks[N]->getTerminator()))
      Found.push_back(Blocks[N]->getTerminator());
  return Found;
}

SmallVector<Instruction *, 4>
IfStatementsResult::choosers(const BasicBlock *From,
                             const BasicBlock *BB) const {
  SmallVector<Instruction *, 4> Found;
  auto It = Decided.find({From, BB});
  if (It != Decided.end())
    append_range(Found, It->second);
  if (It != Decided.end() && Bypassed.contains(From))
    return Found;
  if (const Instruction *T = From->getTerminator(); isPredicate(*T))
    Found.push_back(const_cast<Instruction *>(T));
  append_range(Found, controllers(From));
  return Found;
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
    Flow Graphs(F, Sources);
    ArrayRef<BasicBlock *> Blocks = Graphs.Blocks;
    auto Depends = controlDependence(Graphs.Threaded);
    SmallPtrSet<const BasicBlock *, 8> Passed;
    for (const Flow::Copy &C : Graphs.Copies) {
      Passed.insert(C.BB);
      append_range(R.Decided[{C.BB, C.Next}],
                   predicatesIn(Depends[C.Node], Blocks));
    }
    if (!Passed.empty()) {
      // What a block does that edges were led past is done on all of them;
      // one that does nothing is only the end of a condition.
      auto Before = controlDependence(Graphs.Plain);
      for (unsigned N = 0; N < Blocks.size(); ++N) {
        if (!Graphs.Entered[N])
          R.Bypassed.insert(Blocks[N]);
        if (!Graphs.Entered[N] ||
            (doesSomething(*Blocks[N]) && Passed.contains(Blocks[N])))
          Depends[N] = Before[N];
      }
    }
    for (unsigned N = 0; N < Blocks.size(); ++N) {
      bool ByEntry =
          Depends[N].empty() || is_contained(Depends[N], Blocks.size());
      SmallVector<Instruction *, 2> Controllers =
          predicatesIn(Depends[N], Blocks);
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
