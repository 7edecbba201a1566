//===- LogOne.cpp - What instrumented code calls --------------------------===//
#include "LogOne.h"

#include "Edges.h"
#include "Light.h"
#include "Modes.h"
#include "Runtime.h"

#include <pthread.h>

char tpc_reporting = 1;

namespace tpc {

void emit(Thread &T, Site &S, const Report &R, uint32_t Bits) {
  const bool IsFile = ReportsToFile.load(std::memory_order_acquire);
  if (!IsFile)
    NowSink.load(std::memory_order_acquire)->take(R);
  if (!IsFile && !RingRuns.load(std::memory_order_acquire))
    return;
  LogFile *File = NowFile.load(std::memory_order_acquire);
  if (!File)
    return;
  File->write(T, S, Bits | layout::bits(R.Result, R.Outcome), R.Compared,
              R.Threshold);
  S.StatedIn.store(File, std::memory_order_relaxed);
}

bool isOverCap(Site &S, bool IsFlop) {
  if (!SiteCap.load(std::memory_order_relaxed) &&
      !ProcessCap.load(std::memory_order_relaxed))
    return false;
  int64_t Now = Clock::now();
  auto ProcessTakes = [&] {
    return NowMode.load(std::memory_order_relaxed) == Mode::Light
               ? FairProcessMeter.takes(ProcessCap, Now, S.OfProcess)
               : ProcessMeter.takes(ProcessCap, Now);
  };
  DropCount *Over = !S.Used.takes(SiteCap, Now) ? &S.OverSiteCap
                    : !ProcessTakes()           ? &S.OverProcessCap
                                                : nullptr;
  if (!Over)
    return false;
  Over->Count.fetch_add(1, std::memory_order_relaxed);
  Over->Flops.fetch_add(IsFlop, std::memory_order_relaxed);
  return true;
}

/// One report with caps in force.
static void capped(Thread &T, Site &S, const Report &R) {
  int8_t Last = S.Last.exchange(R.Result ? 1 : 0, std::memory_order_relaxed);
  if (!isOverCap(S, Last >= 0 && Last != R.Result))
    emit(T, S, R, 0);
}

static void report(Thread &T, Report R, const void *Object) {
  if (NowMode.load(std::memory_order_acquire) == Mode::NotStarted)
    startRuntime();
  Mode M = NowMode.load(std::memory_order_acquire);
  Site *S = M == Mode::Off ? nullptr : sites().find(R.Key, Object);
  if (!S)
    return;
  const char *Key = R.Key;
  if (S->Key.size() != S->Length)
    R.Key = S->Key.c_str();
  if (M == Mode::Edges)
    edges(T, *S, R);
  else if (M == Mode::Light)
    light(T, *S, R, Key, Object);
  else if (M == Mode::Capped)
    capped(T, *S, R);
  else
    emit(T, *S, R, 0);
}

/// One report during which the thread cannot be cancelled. It is a function of
/// its own because cancellation is an exception that its handlers must not see.
[[gnu::noinline]] static void uncancelled(const Report &R,
                                          const void *Object) noexcept {
  try {
    Thread *T = ThisThread ? ThisThread : makeThread();
    ReportMark Mark(*T);
    if (Mark)
      report(*T, R, Object);
    else
      T->Nested.fetch_add(1, std::memory_order_relaxed);
  } catch (...) {
    // A report that cannot be made is not worth a node.
  }
}

/// Handles everything that the fast path below does not. A thread must not be
/// cancelled while it uses files, the console or roscpp's locks, so
/// cancellation waits until the program reaches its own cancellation points.
[[gnu::noinline]] static void slowly(const Report &R, const void *Object) {
  int Cancelled;
  pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, &Cancelled);
  uncancelled(R, Object);
  // If the thread may be cancelled at any instruction, it ends here.
  pthread_setcancelstate(Cancelled, nullptr);
}

/// The evaluation if it needs no slow path; otherwise does nothing and returns
/// false.
[[gnu::always_inline]] static inline bool atOnce(Mode M, Thread &T,
                                                 const Site &S, bool Result,
                                                 double Cmp, double Thresh,
                                                 bool Res) {
  if (M == Mode::Light)
    return isPassedOver(S, Result);
  uint32_t Bits = layout::bits(Result, Res);
  return M == Mode::Edges ? edgesAtOnce(T, S, Result, Bits, Cmp, Thresh)
                          : NowFile.load(std::memory_order_acquire)
                                ->writeAtOnce(T, S, Bits, Cmp, Thresh);
}

/// One evaluation under \p Key, of \p Object if that is not null.
[[gnu::always_inline]] static inline void evaluated(const char *Key,
                                                    bool Result, double Cmp,
                                                    double Thresh, bool Res,
                                                    const void *Object) {
  Mode M = NowMode.load(std::memory_order_acquire);
  if (M == Mode::Off)
    return;
  Thread *T = ThisThread;
  if (T && (M == Mode::FileEvery || M == Mode::Edges || M == Mode::Light)) {
    if (ReportMark Mark(*T); Mark)
      if (const Site *S = sites().known(Key, Object);
          S && atOnce(M, *T, *S, Result, Cmp, Thresh, Res))
        return;
  }
  slowly({Key, Result, Cmp, Thresh, Res}, Object);
}

} // namespace tpc

void log_one(char *key, bool result, double cmp, double thresh, bool res) {
  tpc::evaluated(key, result, cmp, thresh, res, nullptr);
}

void log_one_of(char *key, bool result, double cmp, double thresh, bool res,
                const void *object) {
  tpc::evaluated(key, result, cmp, thresh, res, object);
}
