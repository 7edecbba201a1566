//===- Clock.cpp ----------------------------------------------------------===//
#include "Clock.h"

#include <cstdio>
#include <cstring>

namespace tpc {

std::atomic<const Clock::Line *> Clock::Current{nullptr};

/// Whether the kernel trusts the counter: it is the same on all processors and
/// its rate is constant.
static bool counterIsTrusted() {
#if defined(__aarch64__)
  return true;
#elif defined(__x86_64__)
  char Name[32] = "";
  if (FILE *F = std::fopen("/sys/devices/system/clocksource/clocksource0/"
                           "current_clocksource",
                           "re")) {
    if (!std::fgets(Name, sizeof(Name), F))
      Name[0] = 0;
    std::fclose(F);
  }
  return !std::strcmp(Name, "tsc\n");
#else
  return false;
#endif
}

/// Reads both clocks at one instant: the closest of a few tries.
Clock::Line Clock::sample() {
  Line Best{};
  uint64_t Closest = ~uint64_t(0);
  for (int Try = 0; Try < 5; ++Try) {
    uint64_t Before = ticks();
    int64_t Ns = steady();
    uint64_t After = ticks();
    if (After - Before < Closest) {
      Closest = After - Before;
      Best = {Before + (After - Before) / 2, Ns, 0};
    }
  }
  return Best;
}

static bool Trusted = false;

void Clock::prepare() { Trusted = counterIsTrusted(); }

void Clock::adjust() {
  static Line Previous{};
  // A reader may be interrupted for any time while it reads a line; only after
  // a thousand renewals would it see a newer one.
  static Line Lines[1024];
  static unsigned Next = 0;
  if (!Trusted)
    return;
  Line Now = sample();
  if (!Previous.Ticks) {
    Previous = Now;
    return;
  }
  if (Now.Ns - Previous.Ns < 1'000'000)
    return;
  // The rate is measured since the previous reading. The new line continues at
  // the current value of the last one and reaches the clock within a second.
  auto Rate =
      static_cast<int64_t>((static_cast<__int128>(Now.Ns - Previous.Ns) << 32) /
                           static_cast<__int128>(Now.Ticks - Previous.Ticks));
  // The first line is slightly ahead, so that no thread sees time go back when
  // it takes over.
  int64_t Error = 300;
  if (const Line *Last = Current.load(std::memory_order_relaxed)) {
    Error = at(*Last, Now.Ticks) - Now.Ns;
    // After a suspend the clock is right and the line is not.
    if (Error > 1'000'000 || Error < -1'000'000)
      Error = 0;
  }
  Previous = Now;
  Line &L = Lines[Next++ % 1024];
  L.Ticks = Now.Ticks;
  L.Ns = Now.Ns + Error;
  L.Mult = Rate - static_cast<int64_t>((static_cast<__int128>(Rate) * Error) /
                                       1'000'000'000);
  Current.store(&L, std::memory_order_release);
}

} // namespace tpc
