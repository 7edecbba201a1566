//===- Compat.h - Differences between versions of LLVM --------------------===//
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

/// The debug records that say which variable of the source \p V is.
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

/// For an argument: no pointer to it is kept after the call.
inline llvm::Attribute noCapture(llvm::LLVMContext &Ctx) {
#if LLVM_VERSION_MAJOR >= 22
  return llvm::Attribute::getWithCaptureInfo(Ctx, llvm::CaptureInfo::none());
#else
  return llvm::Attribute::get(Ctx, llvm::Attribute::NoCapture);
#endif
}

} // namespace tpc

#endif // TPC_COMPAT_H
