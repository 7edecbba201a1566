//===- ObjectsOfCalls.h - What differs between the calls of a function ----===//
//
// A report inside a function stands for all of its calls. Where the calls pass
// different objects, such as the two sides of an operator of the program, what
// is loaded from such an object is a parameter in one call and none in another.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_OBJECTSOFCALLS_H
#define TPC_OBJECTSOFCALLS_H

#include "memory/PointsTo.h"

#include "llvm/IR/InstrTypes.h"

namespace tpc {

/// True if \p Pointer leads into an object that is an argument of its function,
/// and two of \p Calls, the calls of that function, pass objects for it that
/// have nothing in common.
bool isOfOneCall(const llvm::Value *Pointer,
                 llvm::ArrayRef<llvm::CallBase *> Calls, PointsTo &Pointers);

/// True if isOfOneCall() holds for a pointer that \p V, or what it is computed
/// from in its function, is loaded from.
bool isLoadedForOneCall(const llvm::Value *V,
                        llvm::ArrayRef<llvm::CallBase *> Calls,
                        PointsTo &Pointers);

} // namespace tpc

#endif // TPC_OBJECTSOFCALLS_H
