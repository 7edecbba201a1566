//===- IfStatements.cpp ---------------------------------------------------===//
#include "IfStatements.h"

#include "Budget.h"
#include "ControlDependence.h"
#include "Functions.h"
#include "Options.h"
#include "Print.h"
#include "Throws.h"

#include "llvm/IR/CFG.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/IR/IntrinsicInst.h"
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

/// True where \p BB does more than to choose the way.
static bool doesSomething(const BasicBlock &BB) {
  return any_of(BB, [](const Instruction &I) {
    const auto *Known = dyn_cast<IntrinsicInst>(&I);
    bool AsksForType =
        Known && Known->getIntrinsicID() == Intrinsic::eh_typeid_for;
    return I.mayHaveSideEffects() && !I.isLifetimeStartOrEnd() && !AsksForType;
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
  SmallVector<const CastInst *, 4> Casts;
  while (const auto *I = dyn_cast<Instruction>(Condition)) {
    if (I->getOpcode() == Instruction::Xor && I->getType()->isIntegerTy(1) &&
        isa<ConstantInt>(I->getOperand(1)))
      Negated ^= cast<ConstantInt>(I->getOperand(1))->isOne();
    else if (isa<ZExtInst>(I) || isa<SExtInst>(I) || isa<TruncInst>(I))
      Casts.push_back(cast<CastInst>(I));
    else
      break;
    Condition = I->getOperand(0);
  }
  const auto *Phi = dyn_cast<PHINode>(Condition);
  const ConstantInt *C = Phi ? Known.lookup(Phi) : nullptr;
  if (!C)
    return nullptr;
  APInt Value = C->getValue();
  for (const CastInst *Cast : reverse(Casts)) {
    unsigned Width = Cast->getType()->getIntegerBitWidth();
    Value = isa<SExtInst>(Cast) ? Value.sext(Width) : Value.zextOrTrunc(Width);
  }
  if (const auto *Br = dyn_cast<BranchInst>(&T))
    return Br->getSuccessor(Value.isZero() == Negated ? 0 : 1);
  const auto *Switch = cast<SwitchInst>(&T);
  if (Negated)
    return nullptr;
  for (auto Case : Switch->cases())
    if (Case.getCaseValue()->getValue() == Value)
      return Case.getCaseSuccessor();
  return Switch->getDefaultDest();
}

/// Blocks that are not passed through: they can be left inside.
using LeftInside = DenseMap<const BasicBlock *, SmallVector<Instruction *, 1>>;

/// The blocks from \p BB on that surely follow each other where \p BB is
/// entered from \p From, as far as that is sure. The last one's ways are open;
/// where the first one's are, there is none.
static SmallVector<const BasicBlock *, 4> decidedPath(const BasicBlock *From,
                                                      const BasicBlock *BB,
                                                      const LeftInside &Left) {
  KnownMerges Known;
  SmallVector<const BasicBlock *, 4> Path;
  while (!is_contained(Path, BB) && !Left.contains(BB)) {
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
  SmallVector<const BasicBlock *, 4> Path = decidedPath(From, BB, LeftInside());
  return Path.empty() ? nullptr : Path.back();
}

const Constant *handlerAskedFor(const Instruction &T) {
  const auto *Br = dyn_cast<BranchInst>(&T);
  const auto *Cmp = Br && Br->isConditional()
                        ? dyn_cast<ICmpInst>(Br->getCondition())
                        : nullptr;
  if (!Cmp || Cmp->getPredicate() != CmpInst::ICMP_EQ)
    return nullptr;
  for (const Value *Side : Cmp->operands())
    if (const auto *Id = dyn_cast<IntrinsicInst>(Side);
        Id && Id->getIntrinsicID() == Intrinsic::eh_typeid_for)
      return cast<Constant>(Id->getArgOperand(0));
  return nullptr;
}

/// Where \p T leads an exception of type \p Thrown, in case it asks for that.
static const BasicBlock *chosenByType(const Instruction &T, ThrownType Thrown) {
  const Constant *Handler = handlerAskedFor(T);
  std::optional<bool> Taken =
      Handler ? isTakenBy(Thrown, Handler) : std::nullopt;
  return Taken ? T.getSuccessor(*Taken ? 0 : 1) : nullptr;
}

static bool beginsHandler(const BasicBlock &BB) {
  return any_of(BB, [](const Instruction &I) {
    const auto *Call = dyn_cast<CallBase>(&I);
    return Call && Call->getCalledFunction() &&
           Call->getCalledFunction()->getName() == "__cxa_begin_catch";
  });
}

/// The blocks that an exception of type \p Thrown goes through from \p Invoke
/// on, and the one where it is not sure how it goes on: the handler.
static SmallVector<const BasicBlock *, 4>
pathToHandler(const InvokeInst &Invoke, ThrownType Thrown,
              const LeftInside &Left) {
  KnownMerges Known;
  SmallVector<const BasicBlock *, 4> Path, Sure;
  const BasicBlock *From = Invoke.getParent(), *BB = Invoke.getUnwindDest();
  while (!is_contained(Path, BB) && !Left.contains(BB) && !beginsHandler(*BB)) {
    enterBlock(From, *BB, Known);
    Path.push_back(BB);
    const Instruction &T = *BB->getTerminator();
    const BasicBlock *Next = surelyNext(T, Known);
    if (!Next)
      Next = chosenByType(T, Thrown);
    if (Next) {
      Sure = Path;
      Sure.push_back(Next);
    } else if (const auto *Inner = dyn_cast<InvokeInst>(&T)) {
      Next = Inner->getNormalDest();
    } else if (!(Next = BB->getUniqueSuccessor())) {
      break;
    }
    From = std::exchange(BB, Next);
  }
  return Sure;
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

/// The flow graphs of a function, with the two nodes of Ferrante et al. behind
/// the blocks: the entry, from which the function is either entered or not, and
/// the end of not entering it.
///
/// Of the edges that exceptions take they have those of what the user throws: a
/// call that leads to a `throw` can go on, or to the handler, or out of the
/// function; a block with such calls inside is a node for each part. Edges that
/// end the program (`noexcept`) are none.
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

  Flow(Function &F, UserSources &Sources, const ThrowsResult &Thrown);

  unsigned idOf(const BasicBlock *BB) const { return Id.lookup(BB); }

  /// The blocks, in order; the number of one is that of its node.
  SmallVector<BasicBlock *, 32> Blocks;
  FlowGraph Plain;
  /// Edges into blocks that are decided by the edge lead to copies of them; in
  /// Plain those alone that exceptions take.
  FlowGraph Threaded;
  SmallVector<Copy, 8> Copies;
  size_t NumThrown = 0; ///< The first so many are the ways of exceptions.
  /// Blocks that are also entered where their ways are open, or by exceptions.
  std::vector<bool> Entered;
  LeftInside Left;
  /// For each node of Plain what decides at its end; null where nothing does.
  std::vector<Instruction *> Decider;
  /// A part of a block, behind the call that it begins with.
  struct Part {
    unsigned Block, Node;
    const Instruction *Begin;
  };
  SmallVector<Part, 0> Parts;

private:
  unsigned endOf(BasicBlock &BB);
  void invoke(unsigned Node, InvokeInst &Invoke, const ThrowsResult &Thrown);
  unsigned copy(ArrayRef<const BasicBlock *> Path);
  void findEntered();

  DenseMap<const BasicBlock *, unsigned> Id;
  std::map<std::vector<unsigned>, unsigned> ByPath;
  /// Where calls lead that nobody takes to throw.
  DenseSet<const BasicBlock *> Implicit;
  /// Where those lead that are.
  DenseSet<const BasicBlock *> Explicit;
};

} // namespace

Flow::Flow(Function &F, UserSources &Sources, const ThrowsResult &Thrown) {
  size_t NumParts = 0;
  for (BasicBlock &BB : F) {
    Id[&BB] = Blocks.size();
    Blocks.push_back(&BB);
    for (Instruction &I : BB)
      if (isa<CallInst>(I) && !Thrown.thrownBy(I).empty() && !isThrow(I))
        Left[&BB].push_back(&I), ++NumParts;
  }
  unsigned Size = Blocks.size();
  Plain.resize(Size + 2 + NumParts);
  Threaded.resize(Plain.size());
  Decider.resize(Plain.size());
  Plain[Size] = Threaded[Size] = {Id.lookup(&F.getEntryBlock()), Size + 1};
  SmallVector<unsigned, 32> Ends;
  for (BasicBlock &BB : F) {
    Ends.push_back(endOf(BB));
    if (auto *Invoke = dyn_cast<InvokeInst>(BB.getTerminator()))
      invoke(Ends.back(), *Invoke, Thrown);
  }
  NumThrown = Copies.size();
  Plain.insert(Plain.end(), Threaded.begin() + Plain.size(), Threaded.end());
  for (BasicBlock &BB : F) {
    unsigned N = Ends[Id.lookup(&BB)];
    Instruction *T = BB.getTerminator();
    if (isa<InvokeInst>(T))
      continue;
    Decider[N] = isPredicate(*T) ? T : nullptr;
    bool Library = T->getNumSuccessors() == 2 && T->getDebugLoc() &&
                   !Sources.has(T->getDebugLoc());
    for (const BasicBlock *Succ : successors(&BB)) {
      if (Library && endsProgram(Succ) &&
          !endsProgram(T->getSuccessor(Succ == T->getSuccessor(0) ? 1 : 0)))
        continue;
      Plain[N].push_back(Id.lookup(Succ));
      SmallVector<const BasicBlock *, 4> Path = decidedPath(&BB, Succ, Left);
      unsigned On = Path.empty() ? Id.lookup(Succ) : copy(Path);
      Threaded[N].push_back(On);
    }
  }
  findEntered();
}

/// The node of \p BB that its terminator is in; makes those before it.
unsigned Flow::endOf(BasicBlock &BB) {
  unsigned N = Id.lookup(&BB), Size = Blocks.size();
  auto It = Left.find(&BB);
  if (It == Left.end())
    return N;
  for (Instruction *Call : It->second) {
    unsigned Behind = Size + 2 + Parts.size();
    Parts.push_back({Id.lookup(&BB), Behind, Call});
    Plain[N] = Threaded[N] = {Behind, Size + 1};
    Decider[N] = Call;
    N = Behind;
  }
  return N;
}

void Flow::invoke(unsigned Node, InvokeInst &Invoke,
                  const ThrowsResult &Thrown) {
  const BasicBlock *Pad = Invoke.getUnwindDest();
  ArrayRef<ThrownType> Types = Thrown.thrownBy(Invoke);
  bool Throws = isThrow(Invoke) && !Types.empty();
  if (Types.empty() || isa<UnreachableInst>(Pad->getTerminator())) {
    Implicit.insert(Pad);
    Plain[Node] = Threaded[Node] = {Id.lookup(Invoke.getNormalDest())};
    return;
  }
  if (!Throws) {
    Decider[Node] = &Invoke;
    Plain[Node] = Threaded[Node] = {Id.lookup(Invoke.getNormalDest())};
  }
  Explicit.insert(Pad);
  for (ThrownType Type : Types) {
    SmallVector<const BasicBlock *, 4> Path = pathToHandler(Invoke, Type, Left);
    unsigned On = Path.empty() ? Id.lookup(Pad) : copy(Path);
    if (!is_contained(Threaded[Node], On))
      Threaded[Node].push_back(On);
  }
  Plain[Node] = Threaded[Node];
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
/// nothing that they decide. In Plain they keep those that somebody goes.
/// Blocks that no edge leads to stay, an exception does that nobody threw
/// explicitly.
void Flow::findEntered() {
  std::vector<bool> HasEdge(Plain.size());
  for (const std::vector<unsigned> &Succs : Plain)
    for (unsigned S : Succs)
      HasEdge[S] = true;
  for (const BasicBlock *Pad : Explicit)
    HasEdge[Id.lookup(Pad)] = true;
  for (const BasicBlock *Pad : Implicit)
    HasEdge[Id.lookup(Pad)] = false;
  std::vector<unsigned> Roots;
  for (unsigned N = 0; N < Plain.size(); ++N)
    if (!HasEdge[N])
      Roots.push_back(N);
  std::vector<bool> Reached = reachedFrom(Threaded, Roots);
  for (unsigned N = 0; N < Plain.size(); ++N)
    if (!Reached[N])
      Threaded[N].clear();
  if (NumThrown) {
    std::vector<bool> ReachedPlain = reachedFrom(Plain, Roots);
    for (unsigned N = 0; N < Plain.size(); ++N)
      if (!ReachedPlain[N])
        Plain[N].clear();
  }
  Entered.assign(Reached.begin(), Reached.begin() + Blocks.size());
  DenseMap<unsigned, SmallVector<unsigned, 2>> Gone;
  for (const Copy &C : Copies)
    Gone[idOf(C.BB)].push_back(idOf(C.Next));
  for (const auto &[N, Ways] : Gone)
    if (!Entered[N])
      erase_if(Plain[N], [&](unsigned S) { return !is_contained(Ways, S); });
}

/// What decides at the ends of the nodes in \p Depends; at some, nothing does.
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
  // On the other ways nobody goes: clang has one for a scope's end that is left
  // to none of the places that it can be left to.
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
  const Options Opts = Options::fromCommandLine();
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
      for (const Flow::Part &P : Graphs.Parts)
        if (!Graphs.Entered[P.Block])
          Depends[P.Node] = Before[P.Node];
      // What is done where an exception passes through is done on its ways,
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
      if (I && isa<InvokeInst>(I))
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
