//===- ClassObjectAccess.cpp - Who reads and writes a location ------------===//
#include "ClassObjectAccess.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/Analysis/ValueTracking.h"
#include "llvm/IR/CFG.h"
#include "llvm/IR/Operator.h"

using namespace llvm;

namespace tpc {

/// Variables that a value is followed to by copies of whole objects.
static constexpr unsigned MaxCopied = 16;

AccessResult::Slot AccessResult::slot(const Location &L) {
  if (L.Path.empty())
    return {L.Root, ~0U};
  return {reinterpret_cast<const void *>(
              static_cast<uintptr_t>(L.Path.back().Type) * 16 + 8),
          L.Path.back().Index};
}

/// True where a pointer without a known root can lead to \p L.
bool AccessResult::isReachable(const Location &L) const {
  return !L.Root || !isa<AllocaInst>(L.Root) || Escaped.contains(L.Root);
}

void AccessResult::file(Index &In, unsigned N, const Location &L) const {
  In.Exact[{slot(L), L.Root}].push_back(N);
  if (L.Root && !L.Path.empty() && isReachable(L))
    In.Rooted[slot(L)].push_back(N);
}

/// The numbers of the classes that are in an object of type \p T.
static void classesIn(Type *T, TypeNumbers &Numbers,
                      SmallSetVector<unsigned, 8> &Out) {
  auto *Class = dyn_cast_or_null<StructType>(elementOf(T));
  if (!Class || Class->isOpaque() || !Out.insert(Numbers.numberOf(Class)))
    return;
  for (Type *Field : Class->elements())
    classesIn(Field, Numbers, Out);
}

void AccessResult::fileObject(ObjectIndex &In, unsigned N,
                              const Location &Object) const {
  file(In.BySlot, N, Object);
  if (!isReachable(Object))
    return;
  SmallSetVector<unsigned, 8> Classes;
  classesIn(typeAt(Object), Numbers, Classes);
  for (unsigned Class : Classes)
    In.ByClass[Class].push_back(N);
}

void AccessResult::filePart(PartIndex &In, unsigned N,
                            const Location &L) const {
  if (L.Root)
    file(In.BySlot, N, {L.Root, {}});
  for (size_t K = 1; K <= L.Path.size(); ++K)
    file(In.BySlot, N,
         {L.Root, SmallVector<Step, 4>(ArrayRef(L.Path).take_front(K))});
  if (!L.Root && !L.Path.empty())
    In.ByClass[L.Path[0].Type].push_back(N);
}

/// \p L and the variables that copies of whole objects put its value into, or
/// with \p Backward took it from.
Locations AccessResult::throughCopies(const Location &L, bool Backward) const {
  Locations All{L};
  const ObjectIndex &In = Backward ? CopiesTo : CopiesFrom;
  for (unsigned Next = 0; Next < All.size() && All.size() < MaxCopied; ++Next) {
    const Location Here = All[Next];
    auto Follow = [&](unsigned N) {
      const Copy &C = Copies[N];
      if (All.size() >= MaxCopied)
        return;
      for (const Location &Object : Backward ? C.To : C.From)
        if (auto Rest = partOf(Object, Here))
          for (Location Other : Backward ? C.From : C.To) {
            extend(Other, *Rest);
            if (All.size() < MaxCopied && !is_contained(All, Other))
              All.push_back(std::move(Other));
          }
    };
    eachAround(Here, In.BySlot, Follow);
    if (!Here.Root && !Here.Path.empty())
      if (auto It = In.ByClass.find(Here.Path[0].Type); It != In.ByClass.end())
        for_each(It->second, Follow);
  }
  return All;
}

bool AccessResult::reaches(const Location &From, const Location &To) const {
  return any_of(throughCopies(From, /*Backward=*/false),
                [&](const Location &Here) { return mayBe(Here, To); });
}

void AccessResult::collectWrites(const Location &L,
                                 SmallSetVector<Instruction *, 8> &Out) const {
  for (const Location &Here : throughCopies(L, /*Backward=*/true)) {
    // Several fields that are read as one, in a register: any of them.
    if (isa_and_nonnull<StructType>(elementOf(typeAt(Here))))
      for (Instruction *Write : writesInto(Here))
        if (isa<StoreInst>(Write))
          Out.insert(Write);
    eachAt(Here, StoreIndex, [&](unsigned N) {
      if (mayBe(Stores[N].Where, Here))
        Out.insert(Stores[N].I);
    });
    eachAround(Here, HandedIndex, [&](unsigned N) {
      if (partOf(Handed[N].Where, Here))
        Out.insert(Handed[N].I);
    });
  }
}

void AccessResult::collectLoads(const Location &L,
                                SmallSetVector<LoadInst *, 8> &Out) const {
  for (const Location &Here : throughCopies(L, /*Backward=*/false)) {
    eachAt(Here, LoadIndex, [&](unsigned N) {
      if (mayBe(Loads[N].Where, Here))
        Out.insert(cast<LoadInst>(Loads[N].I));
    });
  }
}

/// True where \p Pointer is one place, not any element of an array.
static bool isOnePlace(const Value *Pointer) {
  while (const auto *GEP = dyn_cast<GEPOperator>(Pointer)) {
    if (!GEP->hasAllConstantIndices())
      return false;
    Pointer = GEP->getPointerOperand();
  }
  return isa<AllocaInst>(Pointer) &&
         !cast<AllocaInst>(Pointer)->getAllocatedType()->isArrayTy();
}

/// The calls that are handed a pointer into \p Local; none where its address is
/// stored away as well, after which any call may be.
static std::optional<SmallVector<Instruction *, 4>>
handedTo(const AllocaInst &Local) {
  SmallVector<Instruction *, 4> Calls;
  SmallVector<const Value *, 8> Work{&Local};
  while (!Work.empty()) {
    const Value *V = Work.pop_back_val();
    for (const Use &U : V->uses()) {
      auto *I = cast<Instruction>(U.getUser());
      if (isa<GetElementPtrInst>(I))
        Work.push_back(I);
      else if (isa<CallBase>(I))
        Calls.push_back(I);
      else if (isa<StoreInst>(I) && U.getOperandNo() == 0 && V == &Local)
        return std::nullopt;
    }
  }
  return Calls;
}

/// What happens to a local variable in its function: the writes of it, and the
/// calls that are handed it, by block and in order.
struct AccessResult::LocalHistory {
  bool Known = false; ///< else anything may happen to it anywhere
  SmallPtrSet<const Instruction *, 8> Writes;
  DenseMap<const BasicBlock *, SmallVector<const Instruction *, 2>> Events;
};

const AccessResult::LocalHistory &
AccessResult::historyOf(const Location &L, ArrayRef<Instruction *> W) const {
  auto &Known = Histories[L.Root];
  for (const auto &[Where, History] : Known)
    if (Where == L)
      return *History;
  const auto &Local = *cast<AllocaInst>(L.Root);
  auto History = std::make_shared<LocalHistory>();
  if (auto Handed = handedTo(Local)) {
    History->Known = true;
    SmallSetVector<Instruction *, 8> All(Handed->begin(), Handed->end());
    for (Instruction *Write : W)
      if (Write->getFunction() == Local.getFunction()) {
        History->Writes.insert(Write);
        All.insert(Write);
      }
    for (const Instruction *I : All)
      History->Events[I->getParent()].push_back(I);
    for (auto &[BB, List] : History->Events)
      sort(List, [](const Instruction *A, const Instruction *B) {
        return A->comesBefore(B);
      });
  }
  Known.push_back({L, History});
  return *Known.back().second;
}

/// Blocks that are walked through for the loads of a module; after that all
/// writes of a local variable are taken to reach all its loads.
static constexpr unsigned MaxWalked = 20'000'000;

/// Leaves in \p W the writes of the local variable \p L that reach \p Load:
/// walks the flow graph back from it and stops at stores that surely replace
/// the value. A write in another function happens at a call that is handed
/// the variable; where its address was stored away, all of them stay.
void AccessResult::reachingWrites(const Instruction &Load, const Location &L,
                                  SmallSetVector<Instruction *, 8> &W) const {
  const LocalHistory &History = historyOf(L, W.getArrayRef());
  if (!History.Known || Walked > MaxWalked)
    return;
  SmallPtrSet<const Instruction *, 8> Reached;
  bool CallReached = false;
  SmallPtrSet<const BasicBlock *, 16> Seen;
  SmallVector<const BasicBlock *, 16> Work;
  // Walks up through the events of a block that come before \p Below; goes on
  // above it where no store has replaced the value.
  auto Through = [&](const BasicBlock *BB, const Instruction *Below) {
    ++Walked;
    if (auto It = History.Events.find(BB); It != History.Events.end())
      for (const Instruction *I : reverse(It->second)) {
        if (Below && !I->comesBefore(Below))
          continue;
        bool Writes = History.Writes.contains(I);
        if (Writes)
          Reached.insert(I);
        CallReached |= isa<CallBase>(I);
        const auto *Store = dyn_cast<StoreInst>(I);
        if (Writes && Store && isOnePlace(Store->getPointerOperand()))
          return;
      }
    for (const BasicBlock *Pred : predecessors(BB))
      if (Seen.insert(Pred).second)
        Work.push_back(Pred);
  };
  Through(Load.getParent(), &Load);
  while (!Work.empty())
    Through(Work.pop_back_val(), nullptr);
  W.remove_if([&](Instruction *Write) {
    return Write->getFunction() == Load.getFunction() ? !Reached.contains(Write)
                                                      : !CallReached;
  });
}

bool AccessResult::isSharedBy(const Location &L, const LoadInst &Load) {
  const auto *Local = dyn_cast_or_null<AllocaInst>(L.Root);
  return !Local || Local->getFunction() != Load.getFunction();
}

ArrayRef<Instruction *>
AccessResult::definitionsOf(const LoadInst &Load) const {
  if (auto It = Definitions.find(&Load); It != Definitions.end())
    return It->second;
  SmallSetVector<Instruction *, 8> All;
  for (const Location &L : touched(Load)) {
    SmallSetVector<Instruction *, 8> Writes;
    collectWrites(L, Writes);
    if (!isSharedBy(L, Load))
      reachingWrites(Load, L, Writes);
    All.insert(Writes.begin(), Writes.end());
  }
  return Definitions[&Load] = All.takeVector();
}

SmallVector<Instruction *, 8> AccessResult::writesOf(const Location &L) const {
  SmallSetVector<Instruction *, 8> Out;
  collectWrites(L, Out);
  return Out.takeVector();
}

SmallVector<LoadInst *, 8> AccessResult::usesOf(const Instruction &Write,
                                                const Value *Pointer) const {
  SmallSetVector<LoadInst *, 8> All;
  for (const Location &L :
       isa<StoreInst>(Write) ? touched(Write) : resolve(Pointer, true))
    collectLoads(L, All);
  All.remove_if([&](LoadInst *Load) {
    return isa<AllocaInst>(getUnderlyingObject(Load->getPointerOperand())) &&
           !is_contained(definitionsOf(*Load), &Write);
  });
  return All.takeVector();
}

SmallVector<Instruction *, 8>
AccessResult::writesInto(const Location &L, const Instruction &At) const {
  SmallVector<Instruction *, 8> All = writesInto(L);
  const auto *Local = dyn_cast_or_null<AllocaInst>(L.Root);
  if (!Local || Local->getFunction() != At.getFunction() || isReachable(L))
    return All;
  // Field by field: the last store before \p At counts.
  SmallPtrSet<const Instruction *, 8> Stores, Reaching;
  LocationSet Seen;
  for (const Instruction *Write : All) {
    const auto *Store = dyn_cast<StoreInst>(Write);
    if (!Store)
      continue;
    Stores.insert(Store);
    for (const Location &Field : touched(*Store)) {
      if (Field.Root != L.Root || !Seen.insert(Field))
        continue;
      SmallSetVector<Instruction *, 8> W;
      collectWrites(Field, W);
      reachingWrites(At, Field, W);
      Reaching.insert(W.begin(), W.end());
    }
  }
  erase_if(All, [&](const Instruction *Write) {
    return Stores.contains(Write) && !Reaching.contains(Write);
  });
  return All;
}

SmallVector<Instruction *, 8>
AccessResult::writesInto(const Location &L) const {
  SmallSetVector<unsigned, 16> Numbers;
  auto Add = [&](unsigned N) {
    if (partOf(L, PartWrites[N].Where))
      Numbers.insert(N);
  };
  eachAt(L, WritesByObject.BySlot, Add);
  if (isReachable(L)) {
    SmallSetVector<unsigned, 8> Classes;
    classesIn(typeAt(L), this->Numbers, Classes);
    for (unsigned Class : Classes)
      if (auto It = WritesByObject.ByClass.find(Class);
          It != WritesByObject.ByClass.end())
        for_each(It->second, Add);
  }
  SmallVector<unsigned, 16> Ordered = Numbers.takeVector();
  sort(Ordered);
  SmallSetVector<Instruction *, 8> Out;
  for (unsigned N : Ordered)
    Out.insert(PartWrites[N].I);
  return Out.takeVector();
}

} // namespace tpc
