//===- Compat.h - What differs between the LLVM releases we build with ----===//
//
// LLVM 19 and 22. Nothing outside this file asks for the version.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_COMPAT_H
#define TPC_COMPAT_H

#include "llvm/Config/llvm-config.h"
#include "llvm/Passes/PassBuilder.h"

#if LLVM_VERSION_MAJOR >= 22
#include "llvm/Plugins/PassPlugin.h"
#else
#include "llvm/Passes/PassPlugin.h"
#endif

#endif // TPC_COMPAT_H
