//===- PointerCopies.h - Copies of pointers that are kept in memory -------===//
//
// A smart pointer is an object that keeps a pointer. Where it leads to is known
// from the smart pointers that it was copied from, and what is written through
// it, from those that were copied from it.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_POINTERCOPIES_H
#define TPC_POINTERCOPIES_H

#include "memory/AccessIndex.h"
#include "memory/PointsTo.h"

#include "llvm/IR/Instructions.h"

namespace tpc {

class PointerCopies {
public:
  PointerCopies(PointsTo &Pointers, AccessIndex &Accesses)
      : Pointers(Pointers), Accesses(Accesses) {}

  /// The stores of pointers to the variable at \p L, and the loads of pointers
  /// from it. \p Object is the object that the variable is in: if \p L names
  /// any of its class, only those that use \p Object itself count.
  llvm::SmallVector<llvm::StoreInst *, 4> storesTo(const Location &L,
                                                   const llvm::Value *Object);
  llvm::SmallVector<llvm::LoadInst *, 4> loadsFrom(const Location &L,
                                                   const llvm::Value *Object);

  /// The variables that \p Stored, the value of a store, is read from, and
  /// those that \p Load, a pointer, is stored to.
  Locations sourcesOf(const llvm::Value *Stored);
  Locations copiesOf(const llvm::LoadInst &Load);

private:
  bool isAt(const llvm::Value *Place, const Location &L,
            const llvm::Value *Object);

  PointsTo &Pointers;
  AccessIndex &Accesses;
};

} // namespace tpc

#endif // TPC_POINTERCOPIES_H
