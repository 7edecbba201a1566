//===- Guard.h - A failure inside is only a failure of what runs inside ---===//
#ifndef TPC_GUARD_H
#define TPC_GUARD_H

#include "llvm/ADT/STLFunctionalExtras.h"

namespace tpc {

/// Ways to fail, for tests.
enum class Failure { None, Crash, Overflow, Fatal, Allocation, Memory, Time };

/// Fails in this way; Memory and Time until the budget is spent.
void fail(Failure Kind);

/// Runs \p F; false where it crashed, ran out of stack or memory, or met what
/// LLVM takes for an internal error (assertions, report_fatal_error). What \p F
/// had made by then is lost: nothing of it may be used, nor destroyed.
///
/// An LLVM without assertions behaves as it likes where one would not hold, and
/// a call that does not come back is not ended.
bool runGuarded(llvm::function_ref<void()> F);

} // namespace tpc

#endif // TPC_GUARD_H
