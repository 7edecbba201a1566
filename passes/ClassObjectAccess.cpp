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

void AccessResult::collectWrites(const Location &L,
                                 SmallSetVector<Instruction *, 8> &Out) const {
  for (const Location &Here : throughCopies(L, /*Backward=*/true)) {
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

/// True where \p I is a call that is handed a pointer into \p Local.
static bool isHanded(const Instruction &I, const Value *Local) {
  const auto *Call = dyn_cast<CallBase>(&I);
  return Call && any_of(Call->args(), [&](const Use &U) {
           const Value *V = U.get();
           while (const auto *GEP = dyn_cast<GEPOperator>(V))
             V = GEP->getPointerOperand();
           return V == Local;
         });
}

/// Leaves in \p W the writes of the local variable \p L that reach \p Load:
/// walks the flow graph back from it and stops at stores that surely replace
/// the value. A write in another function happens at a call that is handed
/// the variable; where its address was stored away, all of them stay.
void AccessResult::reachingWrites(const LoadInst &Load, const Location &L,
                                  SmallSetVector<Instruction *, 8> &W) const {
  const auto *Local = cast<AllocaInst>(L.Root);
  for (const User *U : Local->users())
    if (const auto *Store = dyn_cast<StoreInst>(U);
        Store && Store->getValueOperand() == Local)
      return;
  SmallPtrSet<const Instruction *, 8> Reached;
  bool CallReached = false;
  SmallPtrSet<const BasicBlock *, 16> Seen;
  SmallVector<const BasicBlock *, 16> Work;
  // True where the walk goes on above this instruction.
  auto Step = [&](const Instruction &I) {
    if (W.contains(const_cast<Instruction *>(&I)))
      Reached.insert(&I);
    CallReached |= isHanded(I, Local);
    const auto *Store = dyn_cast<StoreInst>(&I);
    return !(Store && W.contains(const_cast<StoreInst *>(Store)) &&
             isOnePlace(Store->getPointerOperand()));
  };
  auto Above = [&](const BasicBlock *BB) {
    for (const BasicBlock *Pred : predecessors(BB))
      if (Seen.insert(Pred).second)
        Work.push_back(Pred);
  };
  const Instruction *I = Load.getPrevNode();
  while (I && Step(*I))
    I = I->getPrevNode();
  if (!I)
    Above(Load.getParent());
  while (!Work.empty()) {
    const BasicBlock *BB = Work.pop_back_val();
    bool Open = true;
    for (const Instruction &J : reverse(*BB))
      if (!(Open = Step(J)))
        break;
    if (Open)
      Above(BB);
  }
  W.remove_if([&](Instruction *Write) {
    return Write->getFunction() == Load.getFunction() ? !Reached.contains(Write)
                                                      : !CallReached;
  });
}

ArrayRef<Instruction *>
AccessResult::definitionsOf(const LoadInst &Load) const {
  if (auto It = Definitions.find(&Load); It != Definitions.end())
    return It->second;
  SmallSetVector<Instruction *, 8> All;
  for (const Location &L : touched(Load)) {
    SmallSetVector<Instruction *, 8> Writes;
    collectWrites(L, Writes);
    if (const auto *Local = dyn_cast_or_null<AllocaInst>(L.Root);
        Local && Local->getFunction() == Load.getFunction())
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
  for (const Location &L : resolve(Pointer, true))
    collectLoads(L, All);
  All.remove_if([&](LoadInst *Load) {
    return isa<AllocaInst>(getUnderlyingObject(Load->getPointerOperand())) &&
           !is_contained(definitionsOf(*Load), &Write);
  });
  return All.takeVector();
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
