//===- NeverRun.h - Code that no call of its function runs ----------------===//
#ifndef TPC_NEVERRUN_H
#define TPC_NEVERRUN_H

namespace llvm {
class Module;
} // namespace llvm

namespace tpc {

/// Removes from \p M, a copy of a program, the blocks behind branches that
/// always go the other way, because all calls of their function pass the same
/// number: `setMap(Map, /*IsRaw=*/true)`. Functions that other code may call
/// are not changed.
void removeNeverRun(llvm::Module &M);

} // namespace tpc

#endif // TPC_NEVERRUN_H
