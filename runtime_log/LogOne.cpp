//===- LogOne.cpp - What instrumented code calls --------------------------===//
#include "LogOne.h"

#include "Edges.h"
#include "Modes.h"
#include "Runtime.h"

char tpc_reporting = 1;

namespace tpc {

static uint32_t bits(const Report &R) {
  return (R.Result ? layout::ResultBit : 0) |
         (R.Outcome ? layout::OutcomeBit : 0);
}

void emit(Thread &T, Site &S, const Report &R, uint32_t Bits) {
  if (!ReportsToFile.load(std::memory_order_acquire))
    NowSink.load(std::memory_order_acquire)->take(R);
  else if (LogFile *File = NowFile.load(std::memory_order_acquire))
    File->write(T, S, Bits | bits(R), R.Compared, R.Threshold);
}

/// One report under caps.
static void capped(Thread &T, Site &S, const Report &R) {
  int8_t Last = S.Last.exchange(R.Result, std::memory_order_relaxed);
  int64_t Now = Clock::now();
  DropCount *Over = !S.Used.takes(SiteCap, Now)              ? &S.OverSiteCap
                    : !ProcessMeter.takes(ProcessCap, Now) ? &S.OverProcessCap
                                                           : nullptr;
  if (!Over)
    return emit(T, S, R, 0);
  Over->Count.fetch_add(1, std::memory_order_relaxed);
  Over->Flops.fetch_add(Last >= 0 && Last != R.Result,
                        std::memory_order_relaxed);
}

/// What is not on the shortest way.
[[gnu::noinline]] static void slowly(Thread *T, const Report &R) {
  try {
    if (!T && !(T = makeThread()))
      return;
    if (T->Inside.load(std::memory_order_relaxed) & 1) {
      T->Nested.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    T->Inside.store(T->Inside.load(std::memory_order_relaxed) + 1,
                    std::memory_order_relaxed);
    std::atomic_signal_fence(std::memory_order_seq_cst);
    if (NowMode.load(std::memory_order_acquire) == Mode::NotStarted)
      startRuntime();
    Mode M = NowMode.load(std::memory_order_acquire);
    if (M != Mode::Off)
      if (Site *S = sites().find(R.Key)) {
        if (M == Mode::Edges)
          edges(*T, *S, R);
        else if (M == Mode::Capped)
          capped(*T, *S, R);
        else
          emit(*T, *S, R, 0);
      }
  } catch (...) {
    // A report that cannot be made is not worth a node.
  }
  if (T)
    T->Inside.store(T->Inside.load(std::memory_order_relaxed) + 1,
                    std::memory_order_release);
}

} // namespace tpc

using namespace tpc;

void log_one(char *key, bool result, double cmp, double thresh, bool res) {
  Mode M = NowMode.load(std::memory_order_acquire);
  if (M == Mode::Off)
    return;
  Thread *T = ThisThread;
  Report R{key, result, cmp, thresh, res};
  uint32_t Inside;
  if (__builtin_expect((M != Mode::FileEvery && M != Mode::Edges) || !T ||
                           (Inside = T->Inside.load(
                                std::memory_order_relaxed)) & 1,
                       0))
    return slowly(T, R);
  // A signal's handler, or code that is called from here, may report as well.
  T->Inside.store(Inside + 1, std::memory_order_relaxed);
  std::atomic_signal_fence(std::memory_order_seq_cst);
  try {
    if (Site *S = sites().find(key)) {
      if (M == Mode::Edges)
        edges(*T, *S, R);
      else if (LogFile *File = NowFile.load(std::memory_order_acquire))
        File->write(*T, *S, bits(R), cmp, thresh);
    }
  } catch (...) {
    // A report that cannot be made is not worth a node.
  }
  T->Inside.store(Inside + 2, std::memory_order_release);
}
