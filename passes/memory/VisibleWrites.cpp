//===- VisibleWrites.cpp - Which writes a read sees -----------------------===//
//
// Of a local variable by walking its function's flow graph back from the read,
// of what functions share by Reaching.
//
//===----------------------------------------------------------------------===//
#include "memory/ClassObjectAccess.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/Analysis/ValueTracking.h"
#include "llvm/IR/CFG.h"
#include "llvm/IR/Operator.h"

using namespace llvm;

namespace tpc {

//===----------------------------------------------------------------------===//
// Local variables
//===----------------------------------------------------------------------===//

/// True where \p Pointer is one place, not any element of an array.
static bool isOnePlace(const Value *Pointer) {
  while (const auto *GEP = dyn_cast<GEPOperator>(Pointer)) {
    if (!GEP->hasAllConstantIndices())
      return false;
    Pointer = GEP->getPointerOperand();
  }
  return isa<AllocaInst>(Pointer) &&
         !cast<AllocaInst>(Pointer)->isArrayAllocation();
}

/// True where \p U, a use of a pointer or of its number, gives nobody the
/// pointer: it is gone through, compared, or subtracted from another.
static bool keepsNothing(const Use &U) {
  const auto *I = cast<Instruction>(U.getUser());
  if (isa<LoadInst>(I) || isa<CmpInst>(I))
    return true;
  if (isa<StoreInst>(I))
    return U.getOperandNo() == StoreInst::getPointerOperandIndex();
  return I->getOpcode() == Instruction::Sub &&
         all_of(I->operands(),
                [](const Value *V) { return isa<PtrToIntInst>(V); });
}

/// The calls that are handed a pointer into \p Local; none where its address
/// goes elsewhere as well, after which any call may be.
std::optional<SmallVector<Instruction *, 4>>
AccessResult::handedTo(const AllocaInst &Local) const {
  if (KeptElsewhere.contains(&Local))
    return std::nullopt;
  SmallVector<Instruction *, 4> Calls;
  SmallSetVector<const Value *, 8> Names;
  Names.insert(&Local);
  for (unsigned N = 0; N < Names.size(); ++N)
    for (const Use &U : Names[N]->uses()) {
      auto *I = cast<Instruction>(U.getUser());
      if (isa<GetElementPtrInst>(I) || isa<CastInst>(I) || isa<PHINode>(I) ||
          isa<SelectInst>(I) || isa<FreezeInst>(I)) {
        Names.insert(I);
      } else if (isa<CallBase>(I)) {
        Calls.push_back(I);
        // The result may be what was handed over.
        if (I->getType()->isPointerTy() &&
            any_of(Pointers.resolve(I, /*Scalar=*/false),
                   [&](const Location &L) {
                     return L.Root == &Local && !L.isElement();
                   }))
          Names.insert(I);
      } else if (!keepsNothing(U)) {
        return std::nullopt;
      }
    }
  return Calls;
}

/// True where \p Write, in the function of \p Local, writes to it and to no
/// other run's variable of that name.
static bool isByName(const Instruction &Write, const AllocaInst &Local) {
  if (const Value *Pointer = getLoadStorePointerOperand(&Write))
    return getUnderlyingObject(Pointer) == &Local;
  const auto *Call = dyn_cast<CallBase>(&Write);
  return Call && any_of(Call->args(), [&](const Use &Arg) {
           return getUnderlyingObject(Arg) == &Local;
         });
}

/// What happens to a local variable in its function: the writes of it, and the
/// calls that are handed it, by block and in order.
struct AccessResult::LocalHistory {
  bool Known = false; ///< else others may do anything to it anywhere
  SmallPtrSet<const Instruction *, 8> Writes;
  DenseMap<const BasicBlock *, SmallVector<const Instruction *, 2>> Events;
};

const AccessResult::LocalHistory &
AccessResult::historyOf(const Location &L, ArrayRef<Instruction *> W) const {
  auto &Known = Histories[L.Root];
  for (const auto &[Where, History] : Known)
    if (Where.isSame(L))
      return *History;
  const auto &Local = *cast<AllocaInst>(L.Root);
  auto History = std::make_shared<LocalHistory>();
  auto Handed = handedTo(Local);
  History->Known = Handed.has_value();
  SmallSetVector<Instruction *, 8> All;
  if (Handed)
    All.insert(Handed->begin(), Handed->end());
  for (Instruction *Write : W)
    if (Write->getFunction() == Local.getFunction() &&
        (Handed || isByName(*Write, Local))) {
      History->Writes.insert(Write);
      All.insert(Write);
    }
  for (const Instruction *I : All)
    History->Events[I->getParent()].push_back(I);
  for (auto &[BB, List] : History->Events)
    sort(List, [](const Instruction *A, const Instruction *B) {
      return A->comesBefore(B);
    });
  Known.push_back({L, History});
  return *Known.back().second;
}

/// True where \p Store, which writes to \p L, writes all of it: of an array the
/// element that is meant.
bool AccessResult::isOneScalar(const Location &L,
                               const StoreInst &Store) const {
  if (!L.isOne() || isa_and_nonnull<ArrayType>(Types.typeAt(L)))
    return false;
  bool InArray = L.RootItem.isNumber() || any_of(L.Path, [](const Step &S) {
                   return S.Item.isNumber();
                 });
  if (InArray && none_of(Pointers.touched(Store),
                         [&](const Location &Own) { return Own.isSame(L); }))
    return false;
  return Store.getValueOperand()->getType()->isAggregateType() ||
         !isa_and_nonnull<StructType>(Types.typeAt(L));
}

/// True where \p Write, which writes \p L, a local variable, leaves nothing of
/// what was there.
bool AccessResult::replaces(const Instruction &Write, const Location &L) const {
  if (const auto *Store = dyn_cast<StoreInst>(&Write))
    return isOnePlace(Store->getPointerOperand()) && isOneScalar(L, *Store);
  auto It = Replaced.find(&Write);
  if (It == Replaced.end())
    return false;
  const Location &Whole = It->second;
  return Whole.Root == L.Root && Whole.Path.size() <= L.Path.size() &&
         Whole.RootItem.Number == L.RootItem.Number &&
         Location::areSame(Whole.Path,
                           ArrayRef(L.Path).take_front(Whole.Path.size()));
}

/// Blocks that are walked through for the loads of a module; after that all
/// writes of a local variable are taken to reach all its loads.
static constexpr unsigned MaxWalked = 20'000'000;

/// Leaves in \p W the writes of the local variable \p L that reach \p At: walks
/// the flow graph back from it and stops at stores that surely replace the
/// value. A write in another function happens at a call that is handed
/// the variable; where its address was stored away, all of them stay, and only
/// those that name the variable are followed.
void AccessResult::reachingWrites(const Instruction &At, const Location &L,
                                  Writes &W) const {
  const LocalHistory &History = historyOf(L, W.getArrayRef());
  if (Walked > MaxWalked) {
    ++GivenUp;
    return;
  }
  SmallPtrSet<const Instruction *, 8> Reached;
  bool CallReached = false;
  SmallPtrSet<const BasicBlock *, 16> Seen, SeenThrown;
  SmallVector<std::pair<const BasicBlock *, const Instruction *>, 16> Work;
  // Walks up through the events of a block that come before \p Below; goes on
  // above it where no write has replaced the value.
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
        if (Writes && replaces(*I, L))
          return;
      }
    for (const BasicBlock *Pred : predecessors(BB)) {
      // A call that throws has replaced nothing.
      const auto *Invoke = dyn_cast<InvokeInst>(Pred->getTerminator());
      bool Thrown =
          Invoke && Invoke->getUnwindDest() == BB && replaces(*Invoke, L);
      if ((Thrown ? SeenThrown : Seen).insert(Pred).second)
        Work.push_back({Pred, Thrown ? Invoke : nullptr});
    }
  };
  Through(At.getParent(), &At);
  while (!Work.empty()) {
    auto [BB, Below] = Work.pop_back_val();
    Through(BB, Below);
  }
  W.remove_if([&](Instruction *Write) {
    return Write->getFunction() == At.getFunction()
               ? (History.Known || History.Writes.contains(Write)) &&
                     !Reached.contains(Write)
               : History.Known && !CallReached;
  });
}

//===----------------------------------------------------------------------===//
// What functions share
//===----------------------------------------------------------------------===//

/// More writes of one variable are not told apart by who sees them.
static constexpr unsigned MaxNarrowed = 64;

static bool isLocalOf(const Location &L, const Instruction &At) {
  const auto *Local = dyn_cast_or_null<AllocaInst>(L.Root);
  return Local && Local->getFunction() == At.getFunction();
}

/// The pointer of \p I, a load or store, where what it leads to is all that
/// \p I touches; null where that is a part of it.
const Value *AccessResult::placeOf(const Instruction &I) const {
  auto [It, New] = Places.try_emplace(&I, nullptr);
  if (New && none_of(Pointers.partsOf(I),
                     [](const ScalarPart &Part) { return Part.Size; }))
    It->second = getLoadStorePointerOperand(&I);
  return It->second;
}

/// The variable \p L at \p Pointer; none where that is null.
std::optional<Reaching::Variable>
AccessResult::variableAt(const Value *Pointer, const Location &L) const {
  Type *T = elementOf(Types.typeAt(L));
  if (!Pointer || !T || !T->isSized())
    return std::nullopt;
  return Flow->variableAt(Pointer,
                          Layout.getTypeStoreSize(T).getKnownMinValue());
}

/// What \p Write, a write of \p L, writes; none where it may write less, or
/// other things besides.
std::optional<Reaching::Variable>
AccessResult::writtenBy(const Instruction &Write, const Location &L) const {
  if (!isa<StoreInst>(Write)) {
    auto It = Replaced.find(&Write);
    if (It == Replaced.end() || !(It->second == L))
      return std::nullopt;
  }
  return Flow->replacedBy(Write);
}

bool AccessResult::replaces(const CallBase &Call, const Value *Pointer) const {
  std::optional<Reaching::Variable> Own = Flow->replacedBy(Call),
                                    V = Flow->variableAt(Pointer, 1);
  return Own && V && Own->Where == V->Where;
}

const AccessResult::SharedWrites &
AccessResult::sharedWrites(const Location &L) const {
  auto [It, New] = Shared.try_emplace(L);
  SharedWrites &All = It->second;
  if (!New)
    return All;
  collectWrites(L, All.Own, All.Copied);
  // Who sees them is not asked; they are collected again where they are needed.
  All.TooMany = All.Own.size() + All.Copied.size() > MaxNarrowed;
  if (All.TooMany) {
    All.Own.clear();
    All.Copied.clear();
  }
  All.Narrowed = any_of(All.Own, [&](Instruction *Write) {
    return !Flow->isVisible(*Write, writtenBy(*Write, L));
  });
  return All;
}

bool AccessResult::isSharedBy(const Location &L, const Instruction &At,
                              const Value *Pointer) const {
  if (isLocalOf(L, At))
    return false;
  const SharedWrites &All = sharedWrites(L);
  return All.TooMany ||
         (!All.Narrowed && !Flow->isNarrowed(At, variableAt(Pointer, L)));
}

SmallVector<Instruction *, 8>
AccessResult::writesOf(const Location &L, const Instruction &At,
                       const Value *Pointer) const {
  if (isLocalOf(L, At)) {
    Writes All = allWrites(L);
    reachingWrites(At, L, All);
    All.remove_if([&](Instruction *Write) {
      return Write->getFunction() != At.getFunction() &&
             !Flow->reaches(*Write, writtenBy(*Write, L), At,
                            Reaching::anywhereIn(*L.Root));
    });
    return All.takeVector();
  }
  const SharedWrites &All = sharedWrites(L);
  if (All.TooMany)
    return allWrites(L).takeVector();
  Writes Out = All.Own;
  std::optional<Reaching::Variable> Read = variableAt(Pointer, L);
  Out.remove_if([&](Instruction *Write) {
    return !Flow->reaches(*Write, writtenBy(*Write, L), At, Read);
  });
  Out.insert(All.Copied.begin(), All.Copied.end());
  return Out.takeVector();
}

ArrayRef<Instruction *>
AccessResult::definitionsOf(const LoadInst &Load) const {
  // Whoever goes through the list may ask for others.
  if (auto It = Definitions.find(&Load); It != Definitions.end())
    return *It->second;
  Writes All;
  for (const Location &L : Pointers.touched(Load))
    for (Instruction *Write : writesOf(L, Load, placeOf(Load)))
      All.insert(Write);
  auto &Known = Definitions[&Load];
  Known = std::make_unique<SmallVector<Instruction *, 8>>(All.takeVector());
  return *Known;
}

SmallVector<LoadInst *, 8> AccessResult::usesOf(const Instruction &Write,
                                                const Value *Pointer) const {
  SmallSetVector<LoadInst *, 8> All;
  for (const Location &L : isa<StoreInst>(Write)
                               ? Pointers.touched(Write)
                               : Pointers.resolve(Pointer, true)) {
    SmallSetVector<LoadInst *, 8> Own, Copied;
    collectLoads(L, Own, Copied);
    std::optional<Reaching::Variable> Written =
        variableAt(isa<StoreInst>(Write) ? placeOf(Write) : Pointer, L);
    Own.remove_if([&](LoadInst *Load) {
      // Also where it is read through a reference that may be another's.
      if (isLocalOf(L, *Load))
        return !is_contained(definitionsOf(*Load), &Write);
      return !Flow->reaches(Write, Written, *Load,
                            variableAt(placeOf(*Load), L));
    });
    All.insert(Own.begin(), Own.end());
    All.insert(Copied.begin(), Copied.end());
  }
  All.remove_if([&](LoadInst *Load) {
    return isa<AllocaInst>(getUnderlyingObject(Load->getPointerOperand())) &&
           !is_contained(definitionsOf(*Load), &Write);
  });
  return All.takeVector();
}

//===----------------------------------------------------------------------===//
// Whole objects
//===----------------------------------------------------------------------===//

/// The parts of the object at \p L, which \p At is handed by \p Pointer, that
/// \p At's function replaces.
SmallVector<AccessResult::Part, 4>
AccessResult::replacedParts(const Location &L, const Instruction &At,
                            const Value *Pointer) const {
  SmallVector<Part, 4> Parts;
  std::optional<Reaching::Variable> Object = Flow->variableAt(Pointer, 1);
  if (!Object)
    return Parts;
  for (const Instruction *Write :
       Flow->replacingFrom(*At.getFunction(), Object->Where.first)) {
    auto It = Replaced.find(Write);
    // What a call replaces is known where it is among these, or not at all.
    if (It == Replaced.end() && !isa<StoreInst>(Write))
      continue;
    const Locations Own =
        It == Replaced.end() ? Pointers.touched(*Write) : Locations{It->second};
    if (auto Way =
            Own.size() == 1 ? Alias.partOf(L, Own.front()) : std::nullopt;
        Way && !Way->empty())
      Parts.push_back({std::move(*Way), *Flow->replacedBy(*Write)});
  }
  return Parts;
}

SmallVector<Instruction *, 8>
AccessResult::writesInto(const Location &L, const Instruction &At,
                         const Value *Pointer) const {
  Writes Out;
  bool Local = isLocalOf(L, At) && !Alias.isReachable(L);
  std::map<Location, Writes, LocationOrder> Gone;
  SmallVector<Part, 4> Parts;
  if (!Local)
    Parts = replacedParts(L, At, Pointer);
  // Part by part: the last write of it before \p At counts.
  auto Stays = [&](const Instruction &Write, const Location &Where) {
    if (!Local) {
      auto Way = Alias.partOf(L, Where);
      auto It = find_if(Parts, [&](const Part &P) {
        return Way && Location::areSame(P.Way, *Way);
      });
      std::optional<Reaching::Variable> Read;
      if (It != Parts.end())
        Read = It->Variable;
      else if (isLocalOf(L, At))
        Read = Reaching::anywhereIn(*L.Root);
      return Flow->reaches(Write, writtenBy(Write, Where), At, Read);
    }
    auto [It, New] = Gone.try_emplace(Where);
    if (New) {
      Writes All = allWrites(Where), Reaching = All;
      reachingWrites(At, Where, Reaching);
      All.remove_if([&](Instruction *W) { return Reaching.contains(W); });
      It->second = std::move(All);
    }
    return !It->second.contains(const_cast<Instruction *>(&Write));
  };
  for (unsigned N : partsOf(L))
    if (PartWrites[N].I != &At && Stays(*PartWrites[N].I, PartWrites[N].Where))
      Out.insert(PartWrites[N].I);
  return Out.takeVector();
}

} // namespace tpc
