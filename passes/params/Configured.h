//===- Configured.h - Values that the configuration alone decides ---------===//
//
// A threshold is configured: it is computed from parameters and constants. What
// has any other source, such as a message, is measured.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_CONFIGURED_H
#define TPC_CONFIGURED_H

#include "memory/VisibleWrites.h"
#include "params/ParamCallFinder.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/SmallPtrSet.h"

namespace tpc {

/// \p V without the conversions of types around it.
const llvm::Value *stripCasts(const llvm::Value *V);

class Configured {
public:
  Configured(const ParamCallFinder::Result &Reads, const CallGraphResult &Calls,
             PointsTo &Pointers, VisibleWrites &Writes);

  /// True if \p V is computed from parameters and constants alone, for all that
  /// is known; with \p Surely, no message can be in it.
  bool has(const llvm::Value *V, bool Surely = false);
  /// True if \p V is read from a member or global in which the program stores
  /// constants alone: a threshold that somebody wrote down. A local is the
  /// beginning of a computation.
  bool isWrittenDown(const llvm::Value *V) const;

private:
  using Sources = llvm::SmallVector<const llvm::Value *, 8>;
  Locations writtenBy(const llvm::Instruction &Write) const;
  bool addSources(const llvm::Value *V, Sources &Out, bool Surely) const;
  bool addStored(const llvm::LoadInst &Load, Sources &Out, bool Surely) const;
  bool isHanded(const llvm::Instruction &Call,
                llvm::ArrayRef<Location> Variables) const;

  const ParamCallFinder::Result &Reads;
  const CallGraphResult &Calls;
  PointsTo &Pointers;
  VisibleWrites &Writes;
  llvm::SmallPtrSet<const llvm::Value *, 16> Parameters;
  llvm::DenseMap<const llvm::Value *, bool> Known[2];
};

} // namespace tpc

#endif // TPC_CONFIGURED_H
