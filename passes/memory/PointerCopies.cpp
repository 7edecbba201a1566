//===- PointerCopies.cpp --------------------------------------------------===//
#include "memory/PointerCopies.h"

#include "llvm/Analysis/ValueTracking.h"

using namespace llvm;

namespace tpc {

/// True if the variable at \p Place can be the one at \p L, in \p Object.
bool PointerCopies::isAt(const Value *Place, const Location &L,
                         const Value *Object) {
  // Without a root, and in no other object, it is any of its class.
  if (!L.Root && L.Path.size() < 2)
    return Object && getUnderlyingObject(Place) == Object;
  return any_of(Pointers.resolve(Place, true),
                [&](const Location &Other) { return Other.mayEqual(L); });
}

SmallVector<StoreInst *, 4> PointerCopies::storesTo(const Location &L,
                                                    const Value *Object) {
  SmallVector<StoreInst *, 4> Found;
  for (StoreInst *Store : Accesses.storesAt(L))
    if (Store->getValueOperand()->getType()->isPointerTy() &&
        !isa<Constant>(Store->getValueOperand()) &&
        isAt(Store->getPointerOperand(), L, Object))
      Found.push_back(Store);
  return Found;
}

SmallVector<LoadInst *, 4> PointerCopies::loadsFrom(const Location &L,
                                                    const Value *Object) {
  SmallVector<LoadInst *, 4> Found;
  for (LoadInst *Load : Accesses.loadsAt(L))
    if (Load->getType()->isPointerTy() &&
        isAt(Load->getPointerOperand(), L, Object))
      Found.push_back(Load);
  return Found;
}

Locations PointerCopies::sourcesOf(const Value *Stored) {
  const auto *From = dyn_cast<LoadInst>(Stored);
  return From ? Pointers.resolve(From->getPointerOperand(), true) : Locations();
}

Locations PointerCopies::copiesOf(const LoadInst &Load) {
  Locations Found;
  for (const User *U : Load.users())
    if (const auto *Store = dyn_cast<StoreInst>(U);
        Store && Store->getValueOperand() == &Load)
      for (const Location &L :
           Pointers.resolve(Store->getPointerOperand(), true))
        addTo(Found, L);
  return Found;
}

} // namespace tpc
