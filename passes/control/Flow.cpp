//===- Flow.cpp -----------------------------------------------------------===//
#include "control/Flow.h"

#include "Options.h"
#include "control/IfStatements.h"

#include "llvm/ADT/SetVector.h"
#include "llvm/IR/CFG.h"
#include "llvm/IR/IntrinsicInst.h"

using namespace llvm;

namespace tpc {

/// The values of phis that are constant on one path.
using KnownMerges = SmallDenseMap<const PHINode *, const ConstantInt *, 4>;

/// Adds to \p Known the values of the phis of \p BB if it is entered from
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

/// The only successor that \p T can take given the known phis; null if it may
/// take several.
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

/// The blocks from \p BB on that must follow each other if \p BB is entered
/// from \p From. Where the last one goes is not known. Empty if that already
/// holds for \p BB.
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

/// Where \p T, if it checks the type of an exception, leads an exception of
/// type \p Thrown.
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

/// The blocks that an exception of type \p Thrown passes through from \p Invoke
/// on, and the first block whose successor is not known: the handler.
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
    } else {
      Next = BB->getUniqueSuccessor();
      if (!Next)
        break;
    }
    From = std::exchange(BB, Next);
  }
  return Sure;
}

/// How far a failed check is followed.
static constexpr unsigned MaxBlocksOfEnd = 64;

/// True if every way from \p BB soon ends the program or leaves by an
/// exception, as a failed assertion does.
static bool endsProgram(const BasicBlock *BB) {
  SmallSetVector<const BasicBlock *, 16> Work;
  Work.insert(BB);
  bool Ends = false;
  for (unsigned N = 0; N < Work.size(); ++N) {
    const Instruction *T = Work[N]->getTerminator();
    if (isa<UnreachableInst>(T))
      Ends = true;
    else if (const auto *Invoke = dyn_cast<InvokeInst>(T))
      Work.insert(Invoke->getNormalDest());
    else if (succ_empty(T) || Work.size() > MaxBlocksOfEnd)
      return false;
    else
      Work.insert(succ_begin(T), succ_end(T));
  }
  return Ends;
}

/// True if the compiler knows that \p BB is never entered: the default of a
/// switch over where a clean-up goes on, the end of a function without its
/// `return` (at -O0 with a trap), or `__builtin_unreachable`.
static bool isNever(const BasicBlock &BB) {
  const Instruction *First = &*BB.getFirstNonPHIOrDbgOrLifetime();
  if (const auto *Call = dyn_cast<IntrinsicInst>(First);
      Call && Call->getIntrinsicID() == Intrinsic::trap)
    First = First->getNextNode();
  return isa<UnreachableInst>(First);
}

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
  auto Added = drop_begin(Threaded, Plain.size());
  Plain.insert(Plain.end(), Added.begin(), Added.end());
  for (BasicBlock &BB : F) {
    unsigned N = Ends[Id.lookup(&BB)];
    Instruction *T = BB.getTerminator();
    if (isa<InvokeInst>(T))
      continue;
    Decider[N] = isPredicate(*T) ? T : nullptr;
    bool Library = T->getNumSuccessors() == 2 && T->getDebugLoc() &&
                   !Sources.has(T->getDebugLoc());
    for (const BasicBlock *Succ : successors(&BB)) {
      if (isNever(*Succ))
        continue;
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

/// The node that holds the terminator of \p BB; creates the nodes before it.
unsigned Flow::endOf(BasicBlock &BB) {
  unsigned N = Id.lookup(&BB), Size = Blocks.size();
  auto *It = Left.find(&BB);
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

/// The node that represents \p Path, up to its last block.
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

/// Removes the outgoing edges of blocks that all edges bypass: such a block
/// decides nothing. In Plain they keep the edges that are taken. Blocks without
/// incoming edges stay: an exception that nobody throws explicitly reaches
/// them.
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
  Reached.resize(Blocks.size());
  Entered = std::move(Reached);
  MapVector<unsigned, SmallVector<unsigned, 2>> Gone;
  for (const Copy &C : Copies)
    Gone[idOf(C.BB)].push_back(idOf(C.Next));
  for (const auto &[From, Next] : Gone)
    if (!Entered[From])
      erase_if(Plain[From],
               [&Next = Next](unsigned S) { return !is_contained(Next, S); });
}

} // namespace tpc
