//===- LocalWrites.cpp ----------------------------------------------------===//
#include "memory/LocalWrites.h"

#include "support/Budget.h"
#include "support/Functions.h"

#include "llvm/Analysis/ValueTracking.h"
#include "llvm/IR/CFG.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/IR/Operator.h"
#include "llvm/Support/CommandLine.h"

using namespace llvm;

namespace tpc {

LocalWrites::LocalWrites(Module &M, const RuleMatches &Rules,
                         const LocationTypes &Types, PointsTo &Pointers,
                         const AccessIndex &Accesses)
    : Types(Types), Pointers(Pointers), Accesses(Accesses) {
  findKept(M, Rules);
}

void LocalWrites::findKept(Module &M, const RuleMatches &Rules) {
  for (Function &F : definedFunctions(M)) {
    if (Rules.isOpaque(F))
      continue;
    for (const Instruction &I : instructions(F)) {
      if (Budget::isSpent())
        return;
      const auto *Store = dyn_cast<StoreInst>(&I);
      const Value *Kept = Store ? Store->getValueOperand() : nullptr;
      if (!Kept || !Kept->getType()->isPointerTy() || isa<Constant>(Kept))
        continue;
      for (const Location &L : Pointers.resolve(Kept, false))
        if (const auto *Local = dyn_cast_or_null<AllocaInst>(L.Root);
            Local && Local->getFunction() != &F && L.Path.empty())
          KeptElsewhere.insert(Local);
    }
  }
}

/// True if \p Pointer is a single place, not any element of an array.
static bool isOnePlace(const Value *Pointer) {
  while (const auto *GEP = dyn_cast<GEPOperator>(Pointer)) {
    if (!GEP->hasAllConstantIndices())
      return false;
    Pointer = GEP->getPointerOperand();
  }
  return isa<AllocaInst>(Pointer) &&
         !cast<AllocaInst>(Pointer)->isArrayAllocation();
}

/// True if \p U, a use of a pointer or of its number, does not pass the pointer
/// on: it is dereferenced, compared or subtracted from another.
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

/// The calls that get a pointer into \p Local; none if its address is also used
/// elsewhere, so that any call may change it.
std::optional<SmallVector<Instruction *, 4>>
LocalWrites::handedTo(const AllocaInst &Local) {
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
        // The result may be the pointer that was passed.
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

/// True if \p Write, in the function of \p Local, writes to this very variable
/// and not to that of another activation.
static bool isByName(const Instruction &Write, const AllocaInst &Local) {
  if (const Value *Pointer = getLoadStorePointerOperand(&Write))
    return getUnderlyingObject(Pointer) == &Local;
  const auto *Call = dyn_cast<CallBase>(&Write);
  return Call && any_of(Call->args(), [&](const Use &Arg) {
           return getUnderlyingObject(Arg) == &Local;
         });
}

const LocalWrites::History &LocalWrites::historyOf(const Location &L,
                                                   ArrayRef<Instruction *> W) {
  auto &Known = Histories[L.Root];
  for (const auto &[Where, Own] : Known)
    if (Where.isSame(L))
      return *Own;
  const auto &Local = *cast<AllocaInst>(L.Root);
  auto New = std::make_unique<History>();
  auto Handed = handedTo(Local);
  New->Known = Handed.has_value();
  SmallSetVector<Instruction *, 8> All;
  if (Handed)
    All.insert(Handed->begin(), Handed->end());
  for (Instruction *Write : W)
    if (Write->getFunction() == Local.getFunction() &&
        (Handed || isByName(*Write, Local))) {
      New->Writes.insert(Write);
      All.insert(Write);
    }
  for (const Instruction *I : All)
    New->Events[I->getParent()].push_back(I);
  for (auto &[BB, List] : New->Events)
    sort(List, [](const Instruction *A, const Instruction *B) {
      return A->comesBefore(B);
    });
  Known.push_back({L, std::move(New)});
  return *Known.back().second;
}

/// True if \p Store, which writes to \p L, writes all of it; for an array, the
/// known element.
bool LocalWrites::isOneScalar(const Location &L, const StoreInst &Store) {
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

/// True if \p Write leaves nothing of the earlier value of the local variable
/// \p L.
bool LocalWrites::replaces(const Instruction &Write, const Location &L) {
  if (const auto *Store = dyn_cast<StoreInst>(&Write))
    return isOnePlace(Store->getPointerOperand()) && isOneScalar(L, *Store);
  const Location *Whole = Accesses.replacedBy(Write);
  return Whole && Whole->Root == L.Root &&
         Whole->Path.size() <= L.Path.size() &&
         Whole->RootItem.Number == L.RootItem.Number &&
         StepPath::areSame(Whole->Path,
                           L.Path.steps().take_front(Whole->Path.size()));
}

/// Each load walks back through its function, which is quadratic in generated
/// functions. Beyond the limit, all writes of a local variable reach all its
/// loads.
static cl::opt<unsigned> MaxWalked(
    "tpc-max-local-blocks", cl::Hidden, cl::init(20'000'000),
    cl::desc("Basic blocks that are walked for the loads of local variables"));

void LocalWrites::keepReaching(const Instruction &At, const Location &L,
                               AccessIndex::Writes &W) {
  const History &Past = historyOf(L, W.getArrayRef());
  if (Walked > MaxWalked) {
    ++GivenUp;
    return;
  }
  SmallPtrSet<const Instruction *, 8> Reached;
  bool CallReached = false;
  SmallPtrSet<const BasicBlock *, 16> Seen, SeenThrown;
  SmallVector<std::pair<const BasicBlock *, const Instruction *>, 16> Work;
  // Walks up through the events of a block before \p Below; continues above the
  // block if no write replaced the value.
  auto Through = [&](const BasicBlock *BB, const Instruction *Below) {
    ++Walked;
    if (const auto *It = Past.Events.find(BB); It != Past.Events.end())
      for (const Instruction *I : reverse(It->second)) {
        if (Below && !I->comesBefore(Below))
          continue;
        bool Writes = Past.Writes.contains(I);
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
               ? (Past.Known || Past.Writes.contains(Write)) &&
                     !Reached.contains(Write)
               : Past.Known && !CallReached;
  });
}

} // namespace tpc
