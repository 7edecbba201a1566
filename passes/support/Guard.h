//===- Guard.h - Survives a crash of the analysis -------------------------===//
#ifndef TPC_GUARD_H
#define TPC_GUARD_H

#include "llvm/ADT/STLFunctionalExtras.h"

namespace tpc {

/// Ways to fail, for tests.
enum class Failure { None, Crash, Overflow, Fatal, Allocation, Memory, Time };

/// Fails in this way; Memory and Time run until the budget is spent.
void fail(Failure Kind);

/// Runs \p F in a thread of its own and waits for it; false if it crashed, ran
/// out of stack or memory, or hit an internal error of LLVM (assertion,
/// report_fatal_error). After a failure, nothing that \p F made may be used or
/// destroyed.
///
/// If LLVM was built without assertions, a violated assertion has undefined
/// behaviour. A call that never returns is not ended.
bool runGuarded(llvm::function_ref<void()> F);

} // namespace tpc

#endif // TPC_GUARD_H
