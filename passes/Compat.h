//===- Compat.h - What differs between the LLVM releases we build with ----===//
//
// LLVM 19 and 22. Nothing outside this file asks for the version.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_COMPAT_H
#define TPC_COMPAT_H

#include "llvm/Config/llvm-config.h"
#include "llvm/IR/DebugInfo.h"
#include "llvm/Passes/PassBuilder.h"

#if LLVM_VERSION_MAJOR >= 22
#include "llvm/Plugins/PassPlugin.h"
#else
#include "llvm/Passes/PassPlugin.h"
#endif

namespace tpc {

/// The records that say which of the source's variables \p V is.
inline llvm::SmallVector<llvm::DbgVariableRecord *, 2>
variableRecords(llvm::Value *V) {
  llvm::SmallVector<llvm::DbgVariableRecord *, 2> Records;
#if LLVM_VERSION_MAJOR >= 22
  llvm::findDbgValues(V, Records);
#else
  llvm::SmallVector<llvm::DbgValueInst *, 1> Intrinsics;
  llvm::findDbgValues(Intrinsics, V, &Records);
#endif
  return Records;
}

} // namespace tpc

#endif // TPC_COMPAT_H
