//===- PointsToSolver.cpp -------------------------------------------------===//
#include "memory/PointsToSolver.h"

#include "support/Budget.h"
#include "support/Functions.h"
#include "support/Names.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/ADT/Statistic.h"
#include "llvm/Analysis/ValueTracking.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Operator.h"
#include "llvm/Support/CommandLine.h"
#include "llvm/Support/Debug.h"

#include <utility>

using namespace llvm;

namespace tpc {

#define DEBUG_TYPE "tpc-points-to"
STATISTIC(NumRounds, "Rounds of the points-to analysis");

/// Each round follows pointers through memory one step further. Linked lists of
/// allocations would never end.
static cl::opt<unsigned>
    MaxRounds("tpc-max-points-to-rounds", cl::Hidden, cl::init(32),
              cl::desc("Rounds of the points-to analysis"));

const PointsToSolver::Returned &PointsToSolver::returnedBy(const Function &F) {
  auto [It, New] = Results.try_emplace(&F);
  if (!New)
    return It->second;
  SmallVector<const Value *, 4> Work;
  for (const BasicBlock &BB : F)
    if (const auto *Return = dyn_cast<ReturnInst>(BB.getTerminator()))
      if (const Value *V = Return->getReturnValue())
        Work.push_back(V);
  SmallPtrSet<const Value *, 8> Seen;
  while (!Work.empty()) {
    const Value *V = Work.pop_back_val();
    if (!Seen.insert(V).second)
      continue;
    if (const auto *Phi = dyn_cast<PHINode>(V))
      append_range(Work, Phi->incoming_values());
    else if (const auto *Arg = dyn_cast<Argument>(V))
      It->second.Arguments.push_back(Arg->getArgNo());
    else
      It->second.Others.push_back(V);
  }
  return It->second;
}

/// Adds the sources of a pointer that \p Call returns. If the function returns
/// one of its arguments, the argument of this call is meant: std::max(a, b) is
/// a or b.
void PointsToSolver::addReturned(const CallBase &Call, Node &N) {
  for (const Function *Callee : Calls.callees(Call)) {
    const Returned &Result = returnedBy(*Callee);
    for (unsigned Arg : Result.Arguments)
      N.Sources.push_back(Call.getArgOperand(Arg));
    append_range(N.Sources, Result.Others);
  }
}

/// Adds the sources of \p Extract: the pointers that may have been put into
/// that part of a struct that is kept in registers.
void PointsToSolver::addExtracted(const ExtractValueInst &Extract, Node &N) {
  // A pair of an iterator and whether something was inserted.
  const auto *Pair = dyn_cast<CallBase>(Extract.getAggregateOperand());
  if (Pair && Rules.container(*Pair)) {
    N.Container = containerOf(*Pair);
    return;
  }
  SmallVector<const Value *, 4> Work{Extract.getAggregateOperand()};
  SmallPtrSet<const Value *, 8> Seen;
  while (!Work.empty()) {
    const Value *Whole = Work.pop_back_val();
    if (!Seen.insert(Whole).second)
      continue;
    if (const Value *Part =
            FindInsertedValue(const_cast<Value *>(Whole), Extract.getIndices()))
      N.Sources.push_back(Part);
    else if (const auto *Phi = dyn_cast<PHINode>(Whole))
      append_range(Work, Phi->incoming_values());
    else if (const auto *Call = dyn_cast<CallBase>(Whole))
      for (const Function *Callee : Calls.callees(*Call))
        append_range(Work, returnedBy(*Callee).Others);
  }
}

/// Notes the class of the container if \p Call moves elements from one to
/// another: references to them go along.
void PointsToSolver::noteMove(const CallBase &Call) {
  const Function *Callee = Call.getCalledFunction();
  static constexpr StringRef Moves[] = {"swap", "merge", "splice", "extract",
                                        "splice_after"};
  if (Callee && Rules.container(Call) &&
      is_contained(Moves, unscoped(qualifiedName(Callee->getName()))))
    Moved.insert(scopeOf(*Callee));
}

void PointsToSolver::makeNode(Instruction &I) {
  Node N{&I, {}};
  const auto *Call = dyn_cast<CallBase>(&I);
  if (const auto *Phi = dyn_cast<PHINode>(&I))
    append_range(N.Sources, Phi->incoming_values());
  else if (const auto *Select = dyn_cast<SelectInst>(&I))
    N.Sources = {Select->getTrueValue(), Select->getFalseValue()};
  else if (Call && Rules.container(*Call))
    N.Container = containerOf(*Call);
  else if (Call)
    addReturned(*Call, N);
  else if (const auto *Extract = dyn_cast<ExtractValueInst>(&I))
    addExtracted(*Extract, N);
  else if (!isa<LoadInst>(&I))
    return;
  Nodes.push_back(std::move(N));
}

void PointsToSolver::makeNodes() {
  for (Function &F : definedFunctions(M)) {
    for (const Argument &Arg : F.args()) {
      if (!Arg.getType()->isPointerTy())
        continue;
      Node N{&Arg, {}};
      for (const CallBase *Call : Calls.callers(&F))
        if (Arg.getArgNo() < Call->arg_size())
          N.Sources.push_back(Call->getArgOperand(Arg.getArgNo()));
      Nodes.push_back(std::move(N));
    }
    for (Instruction &I : instructions(F)) {
      if (Budget::isSpent())
        return;
      if (auto *Call = dyn_cast<CallBase>(&I);
          Call && Call->hasStructRetAttr() && Rules.container(*Call))
        Iterators[Call->getArgOperand(0)].push_back(containerOf(*Call));
      if (auto *Call = dyn_cast<CallBase>(&I))
        noteMove(*Call);
      if (const auto *Store = dyn_cast<StoreInst>(&I);
          Store && Store->getValueOperand()->getType()->isPointerTy() &&
          !isa<ConstantPointerNull>(Store->getValueOperand()))
        PointerStores.push_back({Store});
      if (I.getType()->isPointerTy())
        makeNode(I);
    }
  }
}

/// The node that must be complete so that all objects that \p V leads to are
/// known. A field is known: it belongs to any object of its class.
unsigned PointsToSolver::neededBy(const Value *V) const {
  while (true) {
    if (const auto *GEP = dyn_cast<GEPOperator>(V)) {
      const auto *Struct = dyn_cast<StructType>(GEP->getSourceElementType());
      if (Struct && !Struct->isLiteral() && GEP->getNumIndices() > 1)
        return AllKnown;
      V = GEP->getPointerOperand();
    } else if (const auto *Freeze = dyn_cast<FreezeInst>(V)) {
      V = Freeze->getOperand(0);
    } else if (isa<AllocaInst>(V) || isa<GlobalVariable>(V) ||
               isa<ConstantPointerNull>(V) || isa<UndefValue>(V)) {
      return AllKnown;
    } else {
      return numberOf(V);
    }
  }
}

/// Finds the nodes that each node and each store of a pointer depends on: they
/// are asked for in each round.
void PointsToSolver::linkNodes() {
  for (auto [Number, N] : enumerate(Nodes))
    Numbers[N.V] = Number;
  Grown.resize(Nodes.size());
  for (Node &N : Nodes) {
    for (const Value *Source : N.Sources) {
      N.Bases.push_back(baseOf(Source));
      N.Needs.push_back(neededBy(Source));
    }
    if (N.Container) {
      N.Base = baseOf(N.Container);
      N.Needs.push_back(neededBy(N.Container));
    } else if (const auto *Load = dyn_cast<LoadInst>(N.V)) {
      N.Base = baseOf(Load->getPointerOperand());
      N.ReadNeeds = neededBy(Load->getPointerOperand());
    }
  }
  for (PointerStore &S : PointerStores) {
    S.To = baseOf(S.I->getPointerOperand());
    S.From = baseOf(S.I->getValueOperand());
    S.Needs = neededBy(S.I->getValueOperand());
  }
}

/// The number of the slot of \p L.
unsigned PointsToSolver::slotOf(const Location &L) {
  auto [It, New] =
      SlotNumbers.try_emplace(LocationIndex::slotOf(L), SlotGrown.size());
  if (New)
    SlotGrown.push_back(0);
  return It->second;
}

/// True if a source of \p N has gained targets.
bool PointsToSolver::isDue(const Node &N) const {
  return !N.Done || hasGrown(N.Base, N.Done) ||
         any_of(N.Bases, [&](unsigned B) { return hasGrown(B, N.Done); }) ||
         any_of(N.Slots, [&](unsigned S) { return SlotGrown[S] > N.Done; });
}

/// The number of the content of \p L.
unsigned PointsToSolver::contentAt(const Location &L, bool Unrooted) {
  auto [It, New] = ContentIndex[Unrooted].try_emplace(L, Contents.size());
  if (New)
    Contents.push_back({L, Unrooted, slotOf(L)});
  return It->second;
}

/// Adds to \p Out the pointers stored at a place so far.
void PointsToSolver::collect(unsigned Number, Locations &Out) {
  const Location Where = Contents[Number].Where;
  bool Unrooted = Contents[Number].Unrooted;
  if (Where.Root && !Where.Path.empty() && Alias.isReachable(Where))
    collect(contentAt({nullptr, Where.Path}, /*Unrooted=*/true), Out);
  Content &C = Contents[Number];
  if (C.Found.size() < MaxLocations &&
      (!C.Done || SlotGrown[C.Slot] > C.Done)) {
    auto Add = [&](unsigned Number) {
      const PointerStore &S = PointerStores[Number];
      if (S.Grown > C.Done && any_of(S.Where, [&](const Location &To) {
            return Alias.mayBe(To, Where);
          }))
        for (const Location &L : S.Stored)
          addTo(C.Found, L);
    };
    if (Where.Root || Unrooted)
      PointerStoreIndex.eachWithRootOf(Where, Add);
    else
      PointerStoreIndex.eachAt(Where, Add);
    C.Done = Now;
  }
  for (const Location &L : C.Found)
    addTo(Out, L);
}

/// Adds the targets of \p N's sources known so far; true if there are new ones.
bool PointsToSolver::update(Node &N) {
  Locations Found;
  if (auto It = R.Targets.find(N.V); It != R.Targets.end())
    Found = It->second;
  size_t Before = Found.size();
  if (Before >= MaxLocations) {
    N.Done = Now;
    return false;
  }
  // What has not grown has nothing to add.
  auto IsNew = [&](unsigned Base) { return !N.Done || hasGrown(Base, N.Done); };
  for (auto [Source, Base] : zip_equal(N.Sources, N.Bases))
    if (IsNew(Base))
      R.addPointees(Source, Found);
  if (N.Container && IsNew(N.Base))
    R.addElements(N.Container, Found);
  if (const auto *Load = dyn_cast<LoadInst>(N.V)) {
    if (IsNew(N.Base)) {
      N.Where = R.resolve(Load->getPointerOperand(), true);
      N.Slots.clear();
      for (const Location &L : N.Where)
        N.Slots.push_back(slotOf(L));
    }
    for (const Location &L : N.Where) {
      // Elements that are kept in nodes point to each other.
      if (L.isElement())
        addTo(Found, L);
      if (auto It = Iterators.find(L.Root); L.Root && It != Iterators.end())
        for (const Value *Container : It->second)
          R.addElements(Container, Found);
      collect(contentAt(L, /*Unrooted=*/false), Found);
    }
  }
  N.Done = Now;
  if (Found.size() == Before)
    return false;
  R.Targets[N.V] = std::move(Found);
  Grown[&N - Nodes.begin()] = ++Now;
  return true;
}

/// Adds the places that \p S stores to, as known so far, and notifies the loads
/// of them; true if there is news.
bool PointsToSolver::update(PointerStore &S, unsigned Number) {
  bool More = false;
  if (!S.Done || hasGrown(S.To, S.Done))
    for (const Location &L : R.resolve(S.I->getPointerOperand(), true))
      if (none_of(S.Where, [&](const Location &K) { return K.isSame(L); })) {
        S.Where.push_back(L);
        S.Slots.push_back(slotOf(L));
        PointerStoreIndex.add(Number, L);
        More = true;
      }
  if (!S.Done || hasGrown(S.From, S.Done)) {
    R.addPointees(S.I->getValueOperand(), S.Stored);
    More = true;
  }
  S.Done = Now;
  if (!More)
    return false;
  S.Grown = ++Now;
  for (unsigned Slot : S.Slots)
    SlotGrown[Slot] = Now;
  return true;
}

/// One round; true if something new was found.
bool PointsToSolver::propagate() {
  bool Changed = false;
  for (Node &N : Nodes)
    if (!Budget::isSpent() && isDue(N))
      Changed |= update(N);
  for (auto [Number, S] : enumerate(PointerStores))
    if (!Budget::isSpent())
      Changed |= update(S, Number);
  return Changed && !Budget::isSpent();
}

/// Notes the pointers to what is copied to, or passed to functions that are not
/// analysed.
void PointsToSolver::noteFilling() {
  auto Add = [&](const Value *Pointer) {
    Fillings.push_back({Pointer, baseOf(Pointer)});
  };
  for (Function &F : definedFunctions(M))
    for (const Instruction &I : instructions(F)) {
      if (Budget::isSpent())
        return;
      const auto *Call = dyn_cast<CallBase>(&I);
      if (const auto *Copy = dyn_cast<MemTransferInst>(&I))
        Add(Copy->getRawDest());
      else if (Call && !isa<IntrinsicInst>(Call) &&
               Calls.callees(*Call).empty())
        for (const Use &Arg : Call->args())
          if (Arg->getType()->isPointerTy())
            Add(Arg);
    }
}

/// Finds the locals that are filled, as far as the pointers to them are known.
void PointsToSolver::findFilled() {
  for (Filling &Each : Fillings) {
    if (Budget::isSpent())
      return;
    if (Each.Done && !hasGrown(Each.Base, Each.Done))
      continue;
    Each.Done = Now;
    for (const Location &L : R.resolve(Each.Pointer, false))
      if (isa_and_nonnull<AllocaInst>(L.Root))
        Filled.insert(L.Root);
  }
}

/// The pointers that are stored at \p L, which many loads read.
PointsToSolver::StoredAt &PointsToSolver::storedAt(const Location &L) {
  auto [It, New] = StoredIndex.try_emplace(L, Stored.size());
  if (!New)
    return Stored[It->second];
  StoredAt &At = Stored.emplace_back();
  PointerStoreIndex.eachAt(L, [&](unsigned S) {
    const PointerStore &Store = PointerStores[S];
    if (any_of(Store.Where,
               [&](const Location &To) { return Alias.mayBe(To, L); }))
      At.Needs.push_back(Store.Needs);
  });
  At.IsComplete = !At.Needs.empty();
  return At;
}

/// True if all pointers that a load finds in memory are complete: it reads
/// fields and variables in which the program stores such pointers and which
/// other code cannot write.
bool PointsToSolver::findsComplete(const Node &Load) {
  // Later rounds may find what it reads.
  if (Load.Where.empty())
    return isComplete(Load.ReadNeeds);
  bool Any = false;
  for (const Location &L : Load.Where) {
    bool IsKnown = L.Root ? !isa<AllocaInst>(L.Root) || !Filled.contains(L.Root)
                          : L.Path.back().isField();
    if (!IsKnown)
      return false;
    StoredAt &At = storedAt(L);
    if (At.Needs.empty())
      continue;
    Any = true;
    // Pointers only stop being complete.
    At.IsComplete = At.IsComplete && areComplete(At.Needs);
    if (!At.IsComplete)
      return false;
  }
  return Any;
}

/// True if only the calls that are known pass objects of this module for
/// \p Arg. Other libraries can call an exported function too, but to an inline
/// function of a library's header they pass objects of their own.
bool PointsToSolver::hasOwnCallers(const Argument &Arg) {
  const Function &F = *Arg.getParent();
  return Calls.allCallsKnown(F) &&
         (F.hasLocalLinkage() || M.getFunction("main") ||
          (F.isWeakForLinker() && !R.Sources.has(F)));
}

/// True if the elements of the container that \p N leads to stay in it.
bool PointsToSolver::keepsElements(const Node &N) const {
  if (Moved.empty())
    return true;
  const Value *V = N.V;
  if (const auto *Pair = dyn_cast<ExtractValueInst>(V))
    V = Pair->getAggregateOperand();
  const Function *Method = cast<CallBase>(V)->getCalledFunction();
  return !Method || !Moved.contains(scopeOf(*Method));
}

/// Arguments lead only to what the calls pass if all calls are known; phis lead
/// only to their operands. An allocation is known by its class alone. True if a
/// pointer that counted as complete no longer does.
bool PointsToSolver::findComplete() {
  bool First = !std::exchange(Assumed, true);
  if (First) {
    for (Node &N : Nodes) {
      const auto *Arg = dyn_cast<Argument>(N.V);
      N.IsComplete = Arg ? !N.Sources.empty() && hasOwnCallers(*Arg)
                         : (N.Container && keepsElements(N)) ||
                               isa<PHINode, SelectInst, LoadInst>(N.V);
      if (N.IsComplete)
        R.Complete.insert(N.V);
    }
  }
  findFilled();
  // Since the last time, stores may have gained places.
  Stored.clear();
  StoredIndex.clear();
  // The largest set that supports itself: removes pointers until no further one
  // must be removed.
  bool Fell = First;
  for (bool Changed = true; Changed;) {
    Changed = false;
    for (auto [Number, N] : enumerate(Nodes)) {
      if (Budget::isSpent())
        return false;
      if (!N.IsComplete)
        continue;
      auto It = R.Targets.find(N.V);
      if ((It == R.Targets.end() || It->second.size() < MaxLocations) &&
          (!isa<LoadInst>(N.V) || First || findsComplete(N)) &&
          areComplete(N.Needs))
        continue;
      N.IsComplete = false;
      R.Complete.erase(N.V);
      Grown[Number] = ++Now;
      Changed = Fell = true;
    }
  }
  return Fell;
}

void PointsToSolver::findTargets() {
  makeNodes();
  linkNodes();
  noteFilling();
  // If a pointer turns out to lead to more than it should, the pointers that
  // depend on it are computed again.
  while (findComplete() && !Budget::isSpent()) {
    unsigned Round = 0;
    while (Round < MaxRounds && propagate())
      ++Round;
    NumRounds += Round;
    if (Round == MaxRounds)
      LLVM_DEBUG(dbgs() << "points-to: stopped at the limit of rounds\n");
  }
  // What has not been checked to the end is not known to be complete.
  if (Budget::isSpent())
    R.Complete.clear();
}

} // namespace tpc
