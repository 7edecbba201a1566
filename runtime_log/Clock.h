//===- Clock.h - Steady time, cheap enough for every report ---------------===//
//
// CLOCK_MONOTONIC in nanoseconds. If the kernel itself keeps time with the
// processor's counter, the counter is read directly. A line through two
// readings of both, renewed every second, converts it to nanoseconds. That
// costs less than half of clock_gettime.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_CLOCK_H
#define TPC_CLOCK_H

#include <atomic>
#include <cstdint>
#include <ctime>

#if defined(__x86_64__)
#include <x86intrin.h>
#endif

namespace tpc {

class Clock {
public:
  /// Steady time. In one thread it never goes back by more than the error of
  /// the line (well below a microsecond).
  static int64_t now() {
    const Line *L = Current.load(std::memory_order_acquire);
    if (__builtin_expect(!L, 0))
      return steady();
    return at(*L, ticks());
  }

  static int64_t steady() { return read(CLOCK_MONOTONIC); }
  static int64_t real() { return read(CLOCK_REALTIME); }

  /// Asks the kernel whether the counter may be used; call before the first
  /// adjust().
  static void prepare();

  /// Renews the line; call from one thread, about once a second. The first call
  /// takes the first reading; from the second on the counter is used.
  static void adjust();

  static bool usesCounter() {
    return Current.load(std::memory_order_relaxed) != nullptr;
  }

private:
  struct Line {
    uint64_t Ticks;
    int64_t Ns;
    int64_t Mult; ///< nanoseconds per tick times 2^32
  };

  static int64_t at(const Line &L, uint64_t Ticks) {
    auto Since = static_cast<int64_t>(Ticks - L.Ticks);
    return L.Ns +
           static_cast<int64_t>((static_cast<__int128>(Since) * L.Mult) >> 32);
  }

  static int64_t read(clockid_t Id) {
    timespec T;
    clock_gettime(Id, &T);
    return T.tv_sec * INT64_C(1'000'000'000) + T.tv_nsec;
  }

  static uint64_t ticks() {
#if defined(__x86_64__)
    return __rdtsc();
#elif defined(__aarch64__)
    uint64_t Ticks;
    asm volatile("mrs %0, cntvct_el0" : "=r"(Ticks));
    return Ticks;
#else
    return 0;
#endif
  }

  static Line sample();

  static std::atomic<const Line *> Current;
};

} // namespace tpc

#endif // TPC_CLOCK_H
