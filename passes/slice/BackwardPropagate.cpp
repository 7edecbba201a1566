//===- BackwardPropagate.cpp ----------------------------------------------===//
#include "slice/BackwardPropagate.h"

#include "Options.h"
#include "calls/ClassHierarchy.h"
#include "calls/SimpleCallGraph.h"
#include "control/IfStatements.h"
#include "control/Throws.h"
#include "memory/VisibleWrites.h"
#include "slice/ExternCallFinder.h"
#include "support/Budget.h"
#include "support/Names.h"
#include "support/Print.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/Analysis/ValueTracking.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

AnalysisKey BackwardPropagate::Key;

std::optional<SliceEntry>
SliceResult::lookup(const Instruction *Predicate) const {
  auto It = Predicates.find(Predicate);
  if (It == Predicates.end())
    return std::nullopt;
  return It->second;
}

SmallVector<SliceStep, 16> SliceResult::pathOf(const SliceEntry &E) const {
  SmallVector<SliceStep, 16> Path{Steps[E.Step]};
  while (Path.back().Why != SliceStep::Exposes)
    Path.push_back(Steps[Path.back().Next]);
  return Path;
}

/// Builds the slice of a module.
class Slicer {
public:
  Slicer(Module &M, ModuleAnalysisManager &AM)
      : Calls(AM.getResult<SimpleCallGraph>(M)),
        Pointers(AM.getResult<PointsToAnalysis>(M)),
        Accesses(AM.getResult<ClassObjectAccess>(M)),
        Writes(AM.getResult<VisibleWritesAnalysis>(M)),
        Ifs(AM.getResult<IfStatements>(M)), Thrown(AM.getResult<Throws>(M)),
        Exposing(AM.getResult<ExternCallFinder>(M)),
        Rules(AM.getResult<RuleAnalysis>(M)),
        Sources(AM.getResult<OptionsAnalysis>(M)) {}

  SliceResult run();

private:
  /// Why an instruction is in the slice; bits.
  enum Reason : unsigned char {
    Runs = 1,      ///< that it runs matters
    Gives = 2,     ///< the value that it gives or writes matters
    Touches = 4,   ///< a call that is handed an object which matters
    Exposes = 8,   ///< an exposing statement
    Throwing = 16, ///< a call: whether it throws matters
  };
  struct Item {
    Instruction *I;
    unsigned char Reasons;
    unsigned Exposing;
    unsigned Step;
  };
  using Why = SliceStep::WhyTy;

  unsigned addStep(Instruction *I, Why Because);
  void enter(Instruction *I, unsigned char Reasons, Why Because);
  void enterDecider(Instruction *Predicate, Why Because);
  void process(const Item &It);
  void enterControllers(const Instruction &I);
  void enterOperands(Instruction &I);
  void enterValue(const Value *V);
  void enterPointer(const Value *V);
  void enterMemory(const Value *Pointer, const Instruction &At);
  void enterMerge(const PHINode &Phi);
  void enterArguments(const CallBase &Call);
  void enterResult(CallBase &Call);
  bool isSeenThrough(const CallBase &Call);
  bool isCounting(const Instruction &I);
  void enterTouched(CallBase &Call);
  void enterVirtualCall(const CallBase &Call);
  void enterThrowers(CallBase &Call);
  void enterDerived(const Value *Pointer);
  void enterPublisher(const Value *Object);
  void enterReachable(CallBase &Call);

  LocationSet SeenWritten, SeenLoaded;
  const CallGraphResult &Calls;
  PointsTo &Pointers;
  AccessIndex &Accesses;
  VisibleWrites &Writes;
  const IfStatementsResult &Ifs;
  const ThrowsResult &Thrown;
  const ExternCallFinder::Result &Exposing;
  const RuleMatches &Rules;
  UserSources Sources;

  SliceResult Result;
  DenseMap<const Instruction *, unsigned char> Seen;
  SmallPtrSet<const Value *, 16> SeenArguments;
  SmallPtrSet<const Value *, 16> SeenPointers;
  /// Writes of what an exposing statement shows that are decided about.
  SmallPtrSet<const Instruction *, 16> Settled;
  SmallVector<Item, 0> Next; ///< what the next round holds
  unsigned Round = 1;
  unsigned Current = 0; ///< exposing statement of the item at hand
  unsigned Here = 0;    ///< step of the item at hand
};

unsigned Slicer::addStep(Instruction *I, Why Because) {
  Result.Steps.push_back({I, Here, Because});
  return Result.Steps.size() - 1;
}

void Slicer::enter(Instruction *I, unsigned char Reasons, Why Because) {
  unsigned char &Have = Seen[I];
  unsigned char New = (Reasons | Runs) & ~Have;
  if (!New)
    return;
  Have |= New;
  Next.push_back({I, New, Current, addStep(I, Because)});
}

/// \p Predicate, or a call that may throw, controls what is at hand: this round
/// is its distance.
void Slicer::enterDecider(Instruction *Predicate, Why Because) {
  if (!isPredicate(*Predicate))
    return enter(Predicate, Throwing, Because);
  auto [It, New] = Result.Predicates.try_emplace(Predicate);
  if (New)
    It->second = {Round, Current, addStep(Predicate, Because)};
  // Which exception is there, those that may throw it decide, not what the
  // landing pads hand over. And that nobody else needs an object any more is
  // what nobody means who lets go of it.
  bool IsGiven = !handlerAskedFor(*Predicate) && !isCounting(*Predicate);
  enter(Predicate, IsGiven ? Gives : Runs, Because);
}

bool Slicer::isCounting(const Instruction &I) {
  const DILocation *Loc = I.getDebugLoc();
  const DISubprogram *F = Loc ? Loc->getScope()->getSubprogram() : nullptr;
  return F && !Sources.has(Loc) && Rules.isCounting(*F);
}

void Slicer::enterControllers(const Instruction &I) {
  for (Instruction *Predicate : Ifs.controllers(I))
    enterDecider(Predicate, Why::Controls);
  if (Ifs.isControlledByEntry(I)) {
    for (CallBase *Call : Calls.callers(I.getFunction()))
      enter(Call, Runs, Why::Calls);
    // One of several functions is chosen as a value is.
    for (Instruction *Mention : Calls.mentions(I.getFunction()))
      enter(Mention, isa<PHINode, SelectInst>(Mention) ? Gives : Runs,
            Why::Mentions);
  }
}

/// The value of \p V matters: what gives it enters the next round.
void Slicer::enterValue(const Value *V) {
  if (V->getType()->isPointerTy())
    return enterPointer(V);
  if (const auto *I = dyn_cast<Instruction>(V))
    return enter(const_cast<Instruction *>(I), Gives, Why::Gives);
  const auto *Arg = dyn_cast<Argument>(V);
  if (!Arg || !SeenArguments.insert(Arg).second)
    return;
  unsigned Inside = Here;
  for (CallBase *Call : Calls.callers(Arg->getParent()))
    if (Arg->getArgNo() < Call->arg_size()) {
      Here = addStep(Call, Why::Passes);
      enterValue(Call->getArgOperand(Arg->getArgNo()));
      Here = Inside;
    }
}

/// Which object a pointer leads to matters where the program chooses it: by
/// an index, a condition, a call or a pointer in memory.
void Slicer::enterPointer(const Value *V) {
  if (const auto *GEP = dyn_cast<GetElementPtrInst>(V)) {
    for (const Use &Index : GEP->indices())
      if (!isa<Constant>(Index))
        enterValue(Index);
    return enterPointer(GEP->getPointerOperand());
  }
  if (isa<PHINode>(V) || isa<SelectInst>(V) || isa<LoadInst>(V) ||
      isa<CallBase>(V))
    enter(const_cast<Instruction *>(cast<Instruction>(V)), Gives, Why::Gives);
}

/// What is in memory at \p Pointer, a scalar or an array of them, matters where
/// \p At reads it.
void Slicer::enterMemory(const Value *Pointer, const Instruction &At) {
  Locations Read = Pointers.resolve(Pointer, true);
  for (Location &L : Read)
    L.widen();
  for (const Location &L : Read) {
    if (Writes.isSharedBy(L, At, Pointer) && !SeenWritten.insert(L).second)
      continue;
    // What was copied there is among the writes; that it was copied matters,
    // too.
    for (Instruction *Copy : Accesses.copiesTo(L))
      enter(Copy, Runs, Why::Writes);
    for (Instruction *Write : Writes.writesOf(L, At, Pointer))
      enter(Write, Gives, Why::Writes);
  }
}

/// A value that control flow merges: the predicates that choose between the
/// ways matter as if they controlled this instruction.
void Slicer::enterMerge(const PHINode &Phi) {
  for (unsigned N = 0; N < Phi.getNumIncomingValues(); ++N) {
    enterValue(Phi.getIncomingValue(N));
    for (Instruction *Predicate :
         Ifs.choosers(Phi.getIncomingBlock(N), Phi.getParent()))
      enterDecider(Predicate, Why::Chooses);
  }
}

/// What \p Call is handed matters.
void Slicer::enterArguments(const CallBase &Call) {
  for (const Use &Arg : Call.args()) {
    enterValue(Arg);
    if (Arg->getType()->isPointerTy() && !Writes.replaces(Call, Arg))
      enterMemory(Arg, Call);
  }
}

void Slicer::enterResult(CallBase &Call) {
  SmallVector<Function *, 1> Callees = Calls.callees(Call);
  if (!Callees.empty()) {
    for (Function *Callee : Callees)
      for (BasicBlock &BB : *Callee)
        if (isa<ReturnInst>(BB.getTerminator()))
          enter(BB.getTerminator(), Gives, Why::Returns);
    return;
  }
  enterArguments(Call);
}

/// True where \p Call only enters functions whose writes are seen by their
/// stores: the user's own, and what holds one and calls it. A library's
/// containers are more opaque.
bool Slicer::isSeenThrough(const CallBase &Call) {
  SmallVector<Function *, 1> Callees = Calls.callees(Call);
  return !Callees.empty() && all_of(Callees, [&](const Function *F) {
    return Sources.has(*F) || Rules.isKept(*F);
  });
}

/// \p Call is handed an object that matters: it may put its other arguments
/// into it, and what is written through a pointer that it returns is in it.
void Slicer::enterTouched(CallBase &Call) {
  // What an exposing statement shows is in the slice from the beginning; the
  // publisher that does it is not among it.
  if (Seen.lookup(&Call) & Exposes)
    return;
  if (!isSeenThrough(Call))
    enterArguments(Call);
  if (Call.getType()->isPointerTy())
    enterDerived(&Call);
}

/// Which object a virtual function of the user's is called on decides what
/// runs.
void Slicer::enterVirtualCall(const CallBase &Call) {
  auto How = ClassHierarchy::match(Call);
  if (How && any_of(Calls.callees(Call),
                    [&](const Function *F) { return Sources.has(*F); }))
    enterPointer(How->Object);
}

/// Whether \p Call throws matters: what throws in the functions that it calls.
void Slicer::enterThrowers(CallBase &Call) {
  for (const Function *Callee : Calls.callees(Call))
    for (CallBase *Inner : Thrown.leaving(Callee))
      enter(Inner, isThrow(*Inner) ? Runs : Throwing, Why::Throws);
}

void Slicer::enterDerived(const Value *Pointer) {
  if (!SeenPointers.insert(Pointer).second)
    return;
  for (const Use &U : Pointer->uses()) {
    auto *I = dyn_cast<Instruction>(U.getUser());
    if (!I || Accesses.isPutIn(U))
      continue;
    if (isa<GetElementPtrInst>(I))
      enterDerived(I);
    else if (auto *Store = dyn_cast<StoreInst>(I);
             Store && Store->getPointerOperand() == Pointer &&
             // What is stored into a local object is known by its place.
             !isa<AllocaInst>(getUnderlyingObject(Pointer)))
      enter(I, Gives, Why::Writes);
    else if (isa<MemTransferInst>(I))
      enter(I, Gives, Why::Writes);
    else if (auto *Call = dyn_cast<CallBase>(I);
             Call && !isa<IntrinsicInst>(I) && !Settled.contains(I) &&
             !endsLife(*Call))
      enter(I, Touches, Why::Writes);
  }
}

/// What is in the publisher at \p Object is not shown; which one it is decides
/// where: what chooses it, the pointer to it that was stored, and what the
/// user's functions return. Of an object that it is in only what chooses that.
void Slicer::enterPublisher(const Value *Object) {
  SmallVector<std::pair<const Value *, bool>, 4> Work{{Object, true}};
  SmallPtrSet<const Value *, 8> Known;
  while (!Work.empty()) {
    auto [V, IsItself] = Work.pop_back_val();
    if (!Known.insert(V).second)
      continue;
    if (const auto *GEP = dyn_cast<GetElementPtrInst>(V)) {
      for (const Use &Index : GEP->indices())
        enterValue(Index);
      Work.push_back({GEP->getPointerOperand(), false});
    } else if (const auto *Arg = dyn_cast<Argument>(V)) {
      for (const CallBase *Call : Calls.callers(Arg->getParent()))
        if (Arg->getArgNo() < Call->arg_size())
          Work.push_back({Call->getArgOperand(Arg->getArgNo()), IsItself});
    } else {
      const auto *Call = dyn_cast<CallBase>(V);
      bool Returned =
          Call && any_of(Calls.callees(*Call),
                         [&](const Function *F) { return Sources.has(*F); });
      if (isa<PHINode, SelectInst>(V) ||
          (IsItself && (isa<LoadInst>(V) || Returned)))
        enterPointer(V);
    }
  }
}

/// All that an exposing statement shows: what is in its arguments.
void Slicer::enterReachable(CallBase &Call) {
  const Rule *Row = Rules.match(Call);
  const Value *Object = Row ? objectOf(Call, *Row) : nullptr;
  for (const Use &Arg : Call.args()) {
    if (Arg.get() == Object) {
      enterPublisher(Object);
      continue;
    }
    enterValue(Arg);
    if (!Arg->getType()->isPointerTy())
      continue;
    for (const Location &L : Pointers.resolve(Arg, false)) {
      for (Instruction *Write : Writes.writesInto(L, Call, Arg))
        enter(Write,
              isa<CallBase>(Write) && !isa<IntrinsicInst>(Write) ? Touches
                                                                 : Gives,
              Why::Writes);
      // The others come too late, or are overwritten.
      for (Instruction *Write : Accesses.writesInto(L))
        Settled.insert(Write);
    }
    enterDerived(Arg);
    Settled.clear();
  }
}

void Slicer::enterOperands(Instruction &I) {
  if (auto *Phi = dyn_cast<PHINode>(&I))
    return enterMerge(*Phi);
  if (auto *Load = dyn_cast<LoadInst>(&I)) {
    // Most loads of a variable that is not local have the same writes.
    bool New = false;
    for (const Location &L : Pointers.touched(*Load))
      New |= !Writes.isSharedBy(L, *Load, Load->getPointerOperand()) ||
             SeenLoaded.insert(L).second;
    if (!New)
      return enterPointer(Load->getPointerOperand());
    // What is copied is among the definitions; that it is, matters too.
    for (const Location &L : Pointers.touched(*Load))
      for (Instruction *Copy : Accesses.copiesTo(L))
        enter(Copy, Runs, Why::Writes);
    for (Instruction *Write : Writes.definitionsOf(*Load)) {
      // What a library sets to a constant, it sets in its constructors.
      const auto *Store = dyn_cast<StoreInst>(Write);
      if (!Store || !isa<Constant>(Store->getValueOperand()) ||
          Sources.has(*Write->getFunction()))
        enter(Write, Gives, Why::Writes);
    }
    return enterPointer(Load->getPointerOperand());
  }
  if (auto *Copy = dyn_cast<MemTransferInst>(&I))
    return enterMemory(Copy->getRawSource(), I);
  if (auto *Call = dyn_cast<CallBase>(&I); Call && !isa<IntrinsicInst>(&I))
    return enterResult(*Call);
  if (auto *Store = dyn_cast<StoreInst>(&I)) {
    enterValue(Store->getValueOperand());
    return enterPointer(Store->getPointerOperand());
  }
  if (isa<SelectInst>(I))
    enterDecider(&I, Why::Chooses);
  for (const Use &Operand : I.operands())
    if (!isa<BasicBlock>(Operand))
      enterValue(Operand);
}

void Slicer::process(const Item &It) {
  Current = It.Exposing;
  Here = It.Step;
  if (It.Reasons & Runs)
    enterControllers(*It.I);
  if (const auto *Call = dyn_cast<CallBase>(It.I))
    enterVirtualCall(*Call);
  if (It.Reasons & Gives)
    enterOperands(*It.I);
  if (It.Reasons & Touches)
    enterTouched(*cast<CallBase>(It.I));
  if (It.Reasons & Throwing)
    enterThrowers(*cast<CallBase>(It.I));
  if (It.Reasons & Exposes)
    enterReachable(*cast<CallBase>(It.I));
}

SliceResult Slicer::run() {
  for (const auto &[N, E] : enumerate(Exposing)) {
    Current = N;
    enter(E.Call, Exposes, Why::Exposes);
  }
  for (; !Next.empty(); ++Round) {
    SmallVector<Item, 0> Items = std::move(Next);
    Next.clear();
    for (const Item &It : Items) {
      if (Budget::isSpent())
        return std::move(Result);
      process(It);
    }
  }
  return std::move(Result);
}

SliceResult BackwardPropagate::run(Module &M, ModuleAnalysisManager &AM) {
  return Slicer(M, AM).run();
}

PreservedAnalyses BackwardPropagatePrinter::run(Module &M,
                                                ModuleAnalysisManager &AM) {
  const SliceResult &R = AM.getResult<BackwardPropagate>(M);
  const auto &Exposing = AM.getResult<ExternCallFinder>(M);
  OS << "slice of " << M.getName() << ": " << R.numPredicates()
     << " predicates\n";
  for (const Instruction *P : AM.getResult<IfStatements>(M).predicates())
    if (std::optional<SliceEntry> E = R.lookup(P))
      OS << "  distance " << E->Distance << " in "
         << P->getFunction()->getName() << place(*P) << " before "
         << Exposing[E->Exposing].Row->Function
         << place(*Exposing[E->Exposing].Call) << '\n';
  return PreservedAnalyses::all();
}

} // namespace tpc
