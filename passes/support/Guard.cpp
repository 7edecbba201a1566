//===- Guard.cpp ----------------------------------------------------------===//
#include "support/Guard.h"

#include "support/Budget.h"

#include "llvm/Support/CrashRecoveryContext.h"
#include "llvm/Support/ErrorHandling.h"

#include <csignal>
#include <cstdlib>
#include <malloc.h>
#include <memory>
#include <vector>

using namespace llvm;

namespace tpc {

/// Gives this thread an alternate signal stack, unless it has one: after a
/// stack overflow a signal handler needs it.
class SignalStack {
public:
  SignalStack() {
    stack_t Now{};
    if (sigaltstack(nullptr, &Now) != 0 || !(Now.ss_flags & SS_DISABLE))
      return;
    Memory = std::make_unique<char[]>(Size);
    Now.ss_sp = Memory.get();
    Now.ss_size = Size;
    Now.ss_flags = 0;
    sigaltstack(&Now, nullptr);
  }
  ~SignalStack() {
    stack_t Off{};
    Off.ss_flags = SS_DISABLE;
    if (Memory)
      sigaltstack(&Off, nullptr);
  }
  SignalStack(const SignalStack &) = delete;
  SignalStack &operator=(const SignalStack &) = delete;

private:
  static constexpr size_t Size = 1 << 17;
  std::unique_ptr<char[]> Memory;
};

/// In bytes. Only what is used of it takes memory.
static constexpr unsigned StackSize = 64 << 20;

bool runGuarded(function_ref<void()> F) {
  CrashRecoveryContext::Enable();
  struct sigaction Before{};
  sigaction(SIGSEGV, nullptr, &Before);
  struct sigaction OnStack = Before;
  OnStack.sa_flags |= SA_ONSTACK;
  sigaction(SIGSEGV, &OnStack, nullptr);
  // By default LLVM handles a fatal error by printing a bug report, and may
  // exit.
  ScopedFatalErrorHandler Fatal(
      [](void *, const char *, bool) { std::abort(); });
  CrashRecoveryContext Context;
  // The C library gives a thread a heap of its own, so that the analysis leaves
  // no gaps in the heap of the link: the passes after it would be slower.
  bool Survived = Context.RunSafelyOnThread(
      [&] {
        SignalStack Stack;
        F();
      },
      StackSize);
  malloc_trim(0);
  sigaction(SIGSEGV, &Before, nullptr);
  return Survived;
}

/// Uses up the stack.
static unsigned overflow(volatile unsigned Depth) {
  volatile char Frame[4096] = {};
  return Depth ? overflow(Depth + 1) + Frame[Depth % sizeof(Frame)] : 0;
}

void fail(Failure Kind) {
  std::vector<std::vector<char>> Memory;
  switch (Kind) {
  case Failure::None:
    return;
  case Failure::Crash:
    LLVM_BUILTIN_TRAP;
    return;
  case Failure::Overflow:
    overflow(1);
    return;
  case Failure::Fatal:
    report_fatal_error("injected");
  case Failure::Allocation:
    // No machine has that much.
    Memory.emplace_back(size_t(1) << 60);
    return;
  case Failure::Memory:
    while (!Budget::isSpent())
      Memory.emplace_back(1 << 16, 'x');
    return;
  case Failure::Time:
    while (!Budget::isSpent())
      ;
    return;
  }
}

} // namespace tpc
