//===- BackwardPropagate.cpp ----------------------------------------------===//
#include "slice/BackwardPropagate.h"

#include "Options.h"
#include "calls/ClassHierarchy.h"
#include "calls/SimpleCallGraph.h"
#include "control/IfStatements.h"
#include "control/Throws.h"
#include "memory/PointerCopies.h"
#include "memory/VisibleWrites.h"
#include "slice/ExternCallFinder.h"
#include "support/Budget.h"
#include "support/Names.h"
#include "support/Print.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/ADT/Statistic.h"
#include "llvm/Analysis/CFG.h"
#include "llvm/Analysis/ValueTracking.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

#define DEBUG_TYPE "tpc-backward-propagate"
STATISTIC(NumPredicates, "Predicates that an exposing statement depends on");

AnalysisKey BackwardPropagate::Key;

std::optional<SliceEntry>
SliceResult::lookup(const Instruction *Predicate) const {
  auto It = Predicates.find(Predicate);
  if (It == Predicates.end())
    return std::nullopt;
  return It->second;
}

std::optional<SliceEntry> SliceResult::shown(const CmpInst *Compare) const {
  auto It = Shown.find(Compare);
  return It == Shown.end() ? std::nullopt : std::optional(It->second);
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
        Debug(AM.getResult<DebugTypesAnalysis>(M)),
        Sources(AM.getResult<OptionsAnalysis>(M)),
        IsThesis(AM.getResult<OptionsAnalysis>(M).Profile == "thesis") {}

  SliceResult run();

private:
  /// Why an instruction is in the slice; bits.
  enum Reason : unsigned char {
    Runs = 1,      ///< whether it runs matters
    Gives = 2,     ///< the value that it computes or writes matters
    Touches = 4,   ///< a call that gets an object which matters
    Exposes = 8,   ///< an exposing statement
    Throwing = 16, ///< a call: whether it throws matters
    Called = 32,   ///< whether its function is called matters
  };
  struct Item {
    Instruction *I;
    unsigned char Reasons;
    unsigned Exposing;
    unsigned Step;
  };
  using Why = SliceStep::WhyTy;

  unsigned addStep(Instruction *I, Why Because);
  bool isOfResult(Why Because) const;
  void enter(Instruction *I, unsigned char Reasons, Why Because);
  void enterDecider(Instruction *Predicate, Why Because);
  void process(const Item &It);
  bool isLeftByOwner(const Function &F);
  void enterControllers(const Instruction &I);
  void enterOperands(Instruction &I);
  void enterValue(const Value *V);
  void enterPointer(const Value *V);
  void enterMemory(const Value *Pointer, const Instruction &At);
  void enterLocations(const Locations &Read, const Value *Pointer,
                      const Instruction &At);
  void enterMerge(const PHINode &Phi);
  void enterArguments(const CallBase &Call);
  void enterResult(CallBase &Call);
  bool isSeenThrough(const CallBase &Call);
  bool isCounting(const Instruction &I);
  bool isLeftBehind(const Instruction &I);
  void enterPutIn(CallBase &Call);
  void enterTouched(CallBase &Call);
  void enterVirtualCall(const CallBase &Call);
  void enterThrowers(CallBase &Call);
  void enterDerived(const Value *Pointer, bool IntoCallees = false);
  void enterContents(const Value *Pointer, Instruction &At, bool IsOfCaller);
  void enterLoadsOf(const Value *Pointer);
  void enterTarget(const Value *Pointer, Instruction &At);
  void enterBorrowed(const Value *Pointer);
  bool isTooLate(const Instruction &Write) const;
  void enterPublisher(const Value *Object);
  void enterReachable(CallBase &Call);

  LocationSet SeenWritten, SeenLoaded;
  /// The classes of which all copies have entered.
  DenseSet<unsigned> CopiedClasses;
  const CallGraphResult &Calls;
  PointsTo &Pointers;
  AccessIndex &Accesses;
  VisibleWrites &Writes;
  const IfStatementsResult &Ifs;
  const ThrowsResult &Thrown;
  const ExternCallFinder::Result &Exposing;
  const RuleMatches &Rules;
  DebugTypes &Debug;
  UserSources Sources;
  const bool IsThesis; ///< only what a predicate decides counts

  SliceResult Result;
  DenseMap<const Instruction *, unsigned char> Seen;
  SmallPtrSet<const Value *, 16> SeenArguments;
  /// Without and with the functions that get the pointer.
  SmallPtrSet<const Value *, 16> SeenPointers[2];
  /// Writes of what an exposing statement shows that have been decided.
  SmallPtrSet<const Instruction *, 16> Settled;
  /// The exposing statement that shows what a smart pointer leads to, while
  /// that is entered.
  const Instruction *ShownAt = nullptr;
  SmallVector<Item, 0> Next; ///< the items of the next round
  unsigned Round = 1;
  unsigned Current = 0; ///< exposing statement of the current item
  unsigned Here = 0;    ///< step of the current item
  /// The current item matters for the result of a call that is in the slice.
  bool OfResult = false;
};

unsigned Slicer::addStep(Instruction *I, Why Because) {
  Result.Steps.push_back({I, Here, Because});
  return Result.Steps.size() - 1;
}

/// True if what enters now only matters for the result of a call that is in the
/// slice: then that call decides whether it runs, and other calls of the
/// function have results of their own.
bool Slicer::isOfResult(Why Because) const {
  if (IsThesis)
    return false;
  return Because == Why::Returns ||
         (OfResult && (Because == Why::Gives || Because == Why::Chooses ||
                       Because == Why::Controls));
}

void Slicer::enter(Instruction *I, unsigned char Reasons, Why Because) {
  // What a lock or a reference count keeps is no value of the robot, and nobody
  // sees what a smart pointer is left with.
  if (Because == Why::Writes && (isCounting(*I) || isLeftBehind(*I)))
    return;
  unsigned char &Have = Seen[I];
  const unsigned char OfCalls = isOfResult(Because) ? 0 : Called;
  unsigned char New = (Reasons | Runs | OfCalls) & ~Have;
  if (!New)
    return;
  Have |= New;
  unsigned Step = addStep(I, Because);
  Next.push_back({I, New, Current, Step});
  if ((New & Gives) && isa<CmpInst>(I) && !IsThesis)
    Result.Shown.try_emplace(I, SliceEntry{Round, Current, Step});
}

/// \p Predicate, or a call that may throw, controls the current item; the
/// number of this round is its distance.
void Slicer::enterDecider(Instruction *Predicate, Why Because) {
  if (!isPredicate(*Predicate))
    return enter(Predicate, Throwing, Because);
  auto [It, New] = Result.Predicates.try_emplace(Predicate);
  if (New)
    It->second = {Round, Current, addStep(Predicate, Because)};
  // For a check of the exception's type, the instructions that throw it matter,
  // not the result of the landing pad. A reference count is no decision of the
  // code that releases an object.
  bool IsGiven = !handlerAskedFor(*Predicate) && !isCounting(*Predicate);
  enter(Predicate, IsGiven ? Gives : Runs, Because);
}

/// True if \p I stores the null that the destructor of a smart pointer leaves
/// in it.
bool Slicer::isLeftBehind(const Instruction &I) {
  const DILocation *Loc = I.getDebugLoc();
  const DISubprogram *F = Loc ? Loc->getScope()->getSubprogram() : nullptr;
  const auto *Store = dyn_cast<StoreInst>(&I);
  return F && Store && isa<ConstantPointerNull>(Store->getValueOperand()) &&
         !Sources.has(Loc) && isDestructor(F->getLinkageName());
}

bool Slicer::isCounting(const Instruction &I) {
  const DILocation *Loc = I.getDebugLoc();
  const DISubprogram *F = Loc ? Loc->getScope()->getSubprogram() : nullptr;
  return F && !Sources.has(Loc) && Rules.isCounting(*F);
}

/// True if \p F ends an object for its last owner, and is in the slice only for
/// what a library stores or computes meanwhile: that is about the library.
bool Slicer::isLeftByOwner(const Function &F) {
  const DISubprogram *SP = F.getSubprogram();
  if (!SP || Sources.has(F) || !Rules.isDestroying(*SP))
    return false;
  const SliceStep *S = &Result.Steps[Here];
  while (S->Why == Why::Controls || S->Why == Why::Calls ||
         S->Why == Why::Mentions || S->Why == Why::Throws)
    S = &Result.Steps[S->Next];
  return S->Why != Why::Exposes && !Sources.has(*S->I->getFunction());
}

void Slicer::enterControllers(const Instruction &I) {
  for (Instruction *Predicate : Ifs.controllers(I))
    enterDecider(Predicate, Why::Controls);
  if (!OfResult && Ifs.isControlledByEntry(I) &&
      !isLeftByOwner(*I.getFunction())) {
    for (CallBase *Call : Calls.callers(I.getFunction()))
      enter(Call, Runs, Why::Calls);
    // Passing on one of several functions is the choice of a value.
    for (Instruction *Mention : Calls.mentions(I.getFunction()))
      enter(Mention, isa<PHINode, SelectInst>(Mention) ? Gives : Runs,
            Why::Mentions);
  }
}

/// The value of \p V matters: what computes it enters the next round.
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

/// Which object a pointer leads to matters if the program chooses it: by an
/// index, a condition, a call or a pointer in memory.
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

/// The memory at \p Pointer, a scalar or an array of scalars, matters where
/// \p At reads it.
void Slicer::enterMemory(const Value *Pointer, const Instruction &At) {
  Locations Read = Pointers.resolve(Pointer, true);
  for (Location &L : Read)
    L.widen();
  enterLocations(Read, Pointer, At);
}

/// What is at \p Read matters where \p At reads it by \p Pointer.
void Slicer::enterLocations(const Locations &Read, const Value *Pointer,
                            const Instruction &At) {
  for (const Location &L : Read) {
    if (Writes.isSharedBy(L, At, Pointer) && !SeenWritten.insert(L).second)
      continue;
    // The writes include what was copied there; that it was copied matters too.
    if (!Writes.isReceived(Pointer))
      for (Instruction *Copy : Accesses.copiesTo(L, CopiedClasses))
        enter(Copy, Runs, Why::Writes);
    for (Instruction *Write : Writes.writesOf(L, At, Pointer))
      enter(Write, Gives, Why::Writes);
  }
}

/// A phi: the predicates that choose between its edges matter as if they
/// controlled this instruction.
void Slicer::enterMerge(const PHINode &Phi) {
  for (unsigned N = 0; N < Phi.getNumIncomingValues(); ++N) {
    enterValue(Phi.getIncomingValue(N));
    for (Instruction *Predicate :
         Ifs.choosers(Phi.getIncomingBlock(N), Phi.getParent()))
      enterDecider(Predicate, Why::Chooses);
  }
}

/// True if the contents of \p Arg matter for the result of \p Call. Of what
/// makes a publisher, only the topic does. The value of a parameter depends on
/// its name and default, not on what else the program keeps in its node.
static bool isUsed(const Value *Arg, const CallBase &Call, const Rule *Row) {
  if (!Row)
    return true;
  if (Row->Kind == Rule::Topic)
    return Arg == argument(Call, *Row, Row->Name);
  return Row->Kind != Rule::Read || Row->Resolve != "node" ||
         Arg != objectOf(Call, *Row);
}

/// The arguments of \p Call matter.
void Slicer::enterArguments(const CallBase &Call) {
  const Rule *Row = Rules.match(Call);
  // No reference to it: the elements of a std::vector<bool> are bits.
  if (const ContainerMethod *Method = Rules.container(Call);
      Method && Method->IsElement && Call.getType()->isIntegerTy()) {
    const Value *Container = containerOf(Call);
    Locations Elements;
    Pointers.addElements(Container, Elements);
    enterLocations(Elements, Container, Call);
  }
  for (const Use &Arg : Call.args()) {
    enterValue(Arg);
    if (Arg->getType()->isPointerTy() && !Writes.replaces(Call, Arg) &&
        isUsed(Arg, Call, Row))
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

/// True if \p Call only enters functions whose writes are seen through their
/// stores: user code, and library code that stores a function and calls it.
/// Containers of a library are opaque.
bool Slicer::isSeenThrough(const CallBase &Call) {
  SmallVector<Function *, 1> Callees = Calls.callees(Call);
  return !Callees.empty() && all_of(Callees, [&](const Function *F) {
    return Sources.has(*F) || Rules.isKept(*F);
  });
}

/// If \p Call puts its arguments into a container, all of each matters.
void Slicer::enterPutIn(CallBase &Call) {
  const ContainerMethod *Method = Rules.container(Call);
  if (!Method || !Method->Writes)
    return;
  const Value *Container = containerOf(Call);
  for (const Use &Arg : Call.args())
    if (Arg->getType()->isPointerTy() && Arg.get() != Container)
      enterContents(Arg, Call, /*IsOfCaller=*/false);
}

/// \p Call gets an object that matters: it may put its other arguments into the
/// object, and may return a pointer into it through which it is written.
void Slicer::enterTouched(CallBase &Call) {
  // What an exposing statement shows is in the slice from the beginning; its
  // publisher is not part of that.
  if (Seen.lookup(&Call) & Exposes)
    return;
  if (!isSeenThrough(Call)) {
    enterArguments(Call);
    enterPutIn(Call);
  }
  if (Call.getType()->isPointerTy())
    enterDerived(&Call);
}

/// The object on which a virtual function of user code is called decides which
/// function runs.
void Slicer::enterVirtualCall(const CallBase &Call) {
  auto How = ClassHierarchy::match(Call);
  if (How && any_of(Calls.callees(Call),
                    [&](const Function *F) { return Sources.has(*F); }))
    enterPointer(How->Object);
}

/// Whether \p Call throws matters: the instructions that throw in the functions
/// that it calls.
void Slicer::enterThrowers(CallBase &Call) {
  for (const Function *Callee : Calls.callees(Call))
    for (CallBase *Inner : Thrown.leaving(Callee))
      enter(Inner, isThrow(*Inner) ? Runs : Throwing, Why::Throws);
}

/// True if \p Write writes what a smart pointer leads to, but only after it was
/// shown.
bool Slicer::isTooLate(const Instruction &Write) const {
  return ShownAt && ShownAt->getFunction() == Write.getFunction() &&
         !isPotentiallyReachable(&Write, ShownAt);
}

/// What is written through \p Pointer and what is computed from it matters,
/// with \p IntoCallees also in the functions that get it.
void Slicer::enterDerived(const Value *Pointer, bool IntoCallees) {
  if (!SeenPointers[IntoCallees].insert(Pointer).second)
    return;
  for (const Use &U : Pointer->uses()) {
    auto *I = dyn_cast<Instruction>(U.getUser());
    if (!I)
      continue;
    if (Accesses.isUnchanged(U)) {
      // A const method may give access to what the object points to.
      if (const auto *Call = dyn_cast<CallBase>(I);
          Call && Call->getType()->isPointerTy() && containerOf(*Call) == U)
        enterDerived(Call, IntoCallees);
      continue;
    }
    // A store into a local object is found by its place.
    const auto *Store = dyn_cast<StoreInst>(I);
    bool IsStoredTo = Store && Store->getPointerOperand() == Pointer &&
                      !isa<AllocaInst>(getUnderlyingObject(Pointer));
    const auto *Call = dyn_cast<CallBase>(I);
    if (isa<GetElementPtrInst>(I))
      enterDerived(I, IntoCallees);
    else if (isTooLate(*I))
      continue;
    else if (IsStoredTo || isa<MemTransferInst>(I) ||
             (isa<MemSetInst>(I) && !Settled.contains(I)))
      enter(I, Gives, Why::Writes);
    else if (Call && !isa<IntrinsicInst>(I) && !Settled.contains(I) &&
             !Calls.onlyDestroys(*Call)) {
      enter(I, Touches, Why::Writes);
      for (Function *Callee : IntoCallees && Call->isArgOperand(&U)
                                  ? Calls.callees(*Call)
                                  : SmallVector<Function *, 1>())
        if (Sources.has(*Callee) &&
            Call->getArgOperandNo(&U) < Callee->arg_size())
          enterDerived(Callee->getArg(Call->getArgOperandNo(&U)), true);
    }
  }
}

/// The contents of the publisher at \p Object are not shown. Which publisher it
/// is decides where the message goes: what chooses it, the stored pointer to
/// it, and what user functions return. If it is part of an object, only what
/// chooses the object.
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

/// The contents of the object at \p Pointer matter where \p At shows them. The
/// writes into an object that is the caller's are also found in the functions
/// that get a pointer to it: nothing else says which object it is.
void Slicer::enterContents(const Value *Pointer, Instruction &At,
                           bool IsOfCaller) {
  for (const Location &L : Pointers.resolve(Pointer, false)) {
    for (Instruction *Write : Writes.writesInto(L, At, Pointer))
      enter(Write,
            isa<CallBase>(Write) && !isa<IntrinsicInst>(Write) ? Touches
                                                               : Gives,
            Why::Writes);
    // The other writes come too late, or are overwritten.
    for (Instruction *Write : Accesses.writesInto(L))
      Settled.insert(Write);
  }
  enterDerived(Pointer, IsOfCaller);
  Settled.clear();
}

/// What is written through the smart pointer that is the argument \p Pointer
/// matters: a library may call the function, so that nothing else says which
/// one it is.
void Slicer::enterLoadsOf(const Value *Pointer) {
  if (!isa<Argument>(Pointer))
    return;
  for (const User *U : Pointer->users())
    if (isa<LoadInst>(U) && U->getType()->isPointerTy())
      enterDerived(U, /*IntoCallees=*/true);
}

/// What the smart pointer at \p Pointer leads to matters where \p At shows it:
/// what is written through the pointers that are read from it, from those that
/// it was copied from, and from copies of those.
void Slicer::enterTarget(const Value *Pointer, Instruction &At) {
  const DIType *T = Debug.pointee(Pointer);
  if (!isSmartPointer(T))
    return;
  ShownAt = &At;
  // Another statement may show what this one is too early for.
  SmallPtrSet<const Value *, 16> SeenElsewhere = std::move(SeenPointers[true]);
  SeenPointers[true].clear();
  PointerCopies Copied(Pointers, Accesses);
  const Value *Object = getUnderlyingObject(Pointer);
  Locations Origins = Pointers.resolve(Pointer, true), Copies;
  // Nothing is written through a pointer to const, but it was one of another
  // type before.
  const size_t NumConst = pointsToConst(T) ? Origins.size() : 0;
  // By value: the lists grow.
  auto EnterLoads = [&](Location Kept, bool IsWritable) {
    for (LoadInst *Load : Copied.loadsFrom(Kept, Object)) {
      if (IsWritable)
        enterDerived(Load, /*IntoCallees=*/true);
      for (const Location &L : Copied.copiesOf(*Load))
        addTo(Copies, L);
    }
  };
  if (NumConst == 0)
    enterLoadsOf(Pointer);
  // A smart pointer may be moved as bytes.
  for (const User *U : Pointer->users())
    if (const auto *Copy = dyn_cast<MemTransferInst>(U);
        Copy && Copy->getRawDest() == Pointer) {
      enterLoadsOf(Copy->getRawSource());
      for (const Location &L : Pointers.resolve(Copy->getRawSource(), true))
        addTo(Origins, L);
    }
  for (size_t N = 0; N < Origins.size(); ++N) {
    const Location Kept = Origins[N];
    EnterLoads(Kept, N >= NumConst);
    for (StoreInst *Store : Copied.storesTo(Kept, Object)) {
      enterDerived(Store->getValueOperand(), /*IntoCallees=*/true);
      if (const auto *From = dyn_cast<LoadInst>(Store->getValueOperand()))
        enterLoadsOf(From->getPointerOperand());
      for (const Location &L : Copied.sourcesOf(Store->getValueOperand()))
        addTo(Origins, L);
    }
  }
  for (size_t N = 0; N < Copies.size(); ++N)
    EnterLoads(Copies[N], /*IsWritable=*/true);
  SeenPointers[true] = std::move(SeenElsewhere);
  ShownAt = nullptr;
}

/// What is written through the message that the object at \p Pointer has
/// borrowed from a publisher matters.
void Slicer::enterBorrowed(const Value *Pointer) {
  std::optional<uint64_t> Offset = borrowedAt(Debug.pointee(Pointer));
  if (!Offset)
    return;
  const Value *Object = getUnderlyingObject(Pointer);
  const DataLayout &Layout = Exposing[Current].At->getDataLayout();
  for (const User *U : Object->users()) {
    const auto *Field = dyn_cast<GetElementPtrInst>(U);
    APInt At(Layout.getIndexTypeSizeInBits(Object->getType()), 0);
    if (!Field || !Field->accumulateConstantOffset(Layout, At) || At != *Offset)
      continue;
    for (const User *Load : Field->users())
      if (isa<LoadInst>(Load) && Load->getType()->isPointerTy())
        enterDerived(Load, /*IntoCallees=*/true);
  }
}

/// Everything that an exposing statement shows: the contents of its arguments.
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
    enterContents(Arg, Call, /*IsOfCaller=*/false);
    enterTarget(Arg, Call);
    enterBorrowed(Arg);
  }
}

/// The value that \p I, a store or memset, writes; null for other writes.
static const Value *valueWrittenBy(const Instruction &I) {
  if (const auto *Fill = dyn_cast<MemSetInst>(&I))
    return Fill->getValue();
  const auto *Store = dyn_cast<StoreInst>(&I);
  return Store ? Store->getValueOperand() : nullptr;
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
    // The definitions include what is copied; that it is copied matters too.
    if (!Writes.isReceived(Load->getPointerOperand()))
      for (const Location &L : Pointers.touched(*Load))
        for (Instruction *Copy : Accesses.copiesTo(L, CopiedClasses))
          enter(Copy, Runs, Why::Writes);
    for (Instruction *Write : Writes.definitionsOf(*Load)) {
      // A constant that library code stores is stored in its constructors.
      if (!isa_and_nonnull<Constant>(valueWrittenBy(*Write)) ||
          Sources.has(*Write->getFunction()))
        enter(Write, Gives, Why::Writes);
    }
    return enterPointer(Load->getPointerOperand());
  }
  if (auto *Copy = dyn_cast<MemTransferInst>(&I)) {
    enterMemory(Copy->getRawSource(), I);
    return enterContents(Copy->getRawSource(), I, /*IsOfCaller=*/false);
  }
  if (auto *Fill = dyn_cast<MemSetInst>(&I)) {
    enterValue(Fill->getValue());
    return enterPointer(Fill->getRawDest());
  }
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
  OfResult = !(It.Reasons & Called);
  if (It.Reasons & (Runs | Called))
    enterControllers(*It.I);
  if (const auto *Call = dyn_cast<CallBase>(It.I))
    enterVirtualCall(*Call);
  if (It.Reasons & Gives)
    enterOperands(*It.I);
  if (It.Reasons & Touches)
    enterTouched(*cast<CallBase>(It.I));
  if (It.Reasons & Throwing)
    enterThrowers(*cast<CallBase>(It.I));
  if (It.Reasons & Exposes) {
    if (auto *Call = dyn_cast<CallBase>(It.I))
      enterReachable(*Call);
    else {
      const Argument *Written = Exposing[It.Exposing].Written;
      enterContents(Written, *It.I, /*IsOfCaller=*/true);
      enterTarget(Written, *It.I);
    }
  }
}

SliceResult Slicer::run() {
  for (const auto &[N, E] : enumerate(Exposing)) {
    Current = N;
    // Who calls an overriding function decides nothing about it.
    if (isa<ReturnInst>(E.At))
      Next.push_back({E.At, E.Written ? Exposes : Gives, Current,
                      addStep(E.At, Why::Exposes)});
    else
      enter(E.At,
            E.IsCall               ? Exposes
            : isa<CallBase>(*E.At) ? Touches
                                   : Gives,
            Why::Exposes);
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
  SliceResult R = Slicer(M, AM).run();
  NumPredicates += R.numPredicates();
  return R;
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
         << Exposing[E->Exposing].Api << place(*Exposing[E->Exposing].At)
         << '\n';
  return PreservedAnalyses::all();
}

} // namespace tpc
