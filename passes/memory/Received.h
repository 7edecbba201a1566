//===- Received.h - Memory that other processes filled --------------------===//
//
// A callback gets a message, and a service its request, from another process.
// Such an object is one of its own: it is none of those of the same class that
// the link unit fills itself, and if the callback does not change it, nothing
// in the link unit writes what is read there. A message that a callback may
// change counts as received if the callback does not change it, unless it is
// behind a smart pointer.
//
// Pointers to them are arguments of callbacks, and what is computed and loaded
// from those, also in the functions that only get such pointers. Found as the
// largest set that supports itself among the pointers that can be reached from
// the callbacks, so that iterators in loops belong to it.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_RECEIVED_H
#define TPC_RECEIVED_H

#include "Options.h"
#include "memory/AccessIndex.h"
#include "memory/PointsTo.h"
#include "support/DebugTypes.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/DenseSet.h"
#include "llvm/ADT/SetVector.h"

namespace tpc {

class CallGraphResult;

class Received {
public:
  Received(llvm::Module &M, const CallGraphResult &Calls, DebugTypes &Debug,
           const LocationTypes &Types, PointsTo &Pointers,
           AccessIndex &Accesses, UserSources Sources);

  /// True if \p Pointer, where it is not null, only leads to what other
  /// processes filled.
  bool has(const llvm::Value *Pointer) const;
  /// True if \p Pointer can lead to what other processes filled, although it
  /// may lead elsewhere, too, for all that is known about who calls a callback.
  bool mayHave(const llvm::Value *Pointer) const;

private:
  bool isHandedOver(const llvm::Argument &Arg);
  bool isOnlyRead(const llvm::Argument &Arg);
  bool isOwn(const Location &L);
  bool isPassedOn(const llvm::CallBase &Call, unsigned N);
  bool handsOver(const llvm::CallBase &Call, unsigned N);
  void addUsersOf(const llvm::Value *Pointer);
  bool isSupported(const llvm::Value *Pointer);

  const CallGraphResult &Calls;
  DebugTypes &Debug;
  const LocationTypes &Types;
  PointsTo &Pointers;
  AccessIndex &Accesses;
  UserSources Sources;
  /// The result of isPassedOn() for arguments of calls.
  llvm::DenseMap<const llvm::Use *, bool> PassedOn;
  /// Arguments, phis, selects and loads; all others are computed from those.
  llvm::SmallSetVector<const llvm::Value *, 16> Found;
  /// All that were reached from the callbacks.
  llvm::DenseSet<const llvm::Value *> Reached;
};

} // namespace tpc

#endif // TPC_RECEIVED_H
