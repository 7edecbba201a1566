//===- Callbacks.h - Functions that a library calls later -----------------===//
//
// A row of kind Callback names arguments that are functions: lambdas,
// std::functions and bound methods. This finds the functions of the program
// that such an argument calls.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_CALLBACKS_H
#define TPC_CALLBACKS_H

#include "Options.h"
#include "Rules.h"

#include "llvm/ADT/SetVector.h"

namespace tpc {

/// The functions in user code that the function object or pointer \p Callback,
/// an argument of \p Call, calls. The first of them on each way through library
/// code counts. If none is found, those of the lambdas for whose types the
/// called template was made.
llvm::SmallSetVector<llvm::Function *, 2>
calledBackBy(const llvm::Value &Callback, const llvm::CallBase &Call,
             UserSources &Sources);

} // namespace tpc

#endif // TPC_CALLBACKS_H
