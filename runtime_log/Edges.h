//===- Edges.h - The policy `edges` ---------------------------------------===//
//
// Each flop is reported. All evaluations are summarised for each site, thread
// and period. A thread adds to its own slots without a lock, alternating
// between a slot for even and one for odd periods. The helper thread begins a
// new period, waits until no thread is inside the old one, and takes its slots.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_EDGES_H
#define TPC_EDGES_H

#include "Sink.h"
#include "Sites.h"
#include "Threads.h"

namespace tpc {

/// The file that contains the slots if the sink is a file; otherwise null.
extern std::atomic<LogFile *> SlotsHome;

/// The current period.
extern std::atomic<uint32_t> NowPeriod;

/// An evaluation is far if |compared - threshold| is larger than this
/// (docs/reference/runtime.md).
constexpr double FarFrom = 1e-4;

template <typename T> inline void setIf(bool Changes, T &To, T Value) {
  if (__builtin_expect(Changes, 0)) {
    To = Value;
    // Forces a branch: the compiler must not store unconditionally.
    asm volatile("" ::: "memory");
  }
}

/// Adds one evaluation of finite values to a slot. \p Bits are those of the
/// outcomes.
[[gnu::always_inline]] inline void add(layout::Slot &To, uint32_t Bits,
                                       double Compared, double Threshold) {
  layout::Summary &K = To.Kept;
  // A reader of the file sees from Begun and Count whether the process ended in
  // between.
  To.Begun += 1;
  std::atomic_signal_fence(std::memory_order_release);
  double Diff = Compared - Threshold;
  double Size = __builtin_fabs(Diff);
  double Low = Compared < Threshold ? Compared : Threshold;
  double High = Compared > Threshold ? Compared : Threshold;
  K.DiffSum += Diff;
  K.AbsSum += Size;
  K.Far += Size > FarFrom;
  K.Compared = Compared;
  // These seldom change, and a comparison is cheaper than a store.
  setIf(Diff < K.DiffMin, K.DiffMin, Diff);
  setIf(Diff > K.DiffMax, K.DiffMax, Diff);
  setIf(Low < K.Low, K.Low, Low);
  setIf(High > K.High, K.High, High);
  setIf(Threshold != K.Threshold, K.Threshold, Threshold);
  setIf(K.What != (layout::SummaryRecord | Bits), K.What,
        layout::SummaryRecord | Bits);
  std::atomic_signal_fence(std::memory_order_release);
  K.Count += 1;
}

/// Records one evaluation.
void edges(Thread &T, Site &S, const Report &R);

/// The same if the evaluation is no flop and needs no slow path; otherwise does
/// nothing and returns false.
[[gnu::always_inline]] inline bool edgesAtOnce(Thread &T, const Site &S,
                                               bool Result, uint32_t Bits,
                                               double Compared,
                                               double Threshold) {
  if (S.Number > T.PairCount ||
      T.PairsHome.load(std::memory_order_relaxed) !=
          SlotsHome.load(std::memory_order_relaxed) ||
      S.Last.load(std::memory_order_relaxed) != Result)
    return false;
  SlotPair *Pair = T.Pairs[S.Number - 1];
  if (!Pair)
    return false;
  uint32_t Now = NowPeriod.load(std::memory_order_acquire);
  layout::Slot &In = Pair->Of[Now & 1];
  // Also false for NaN.
  if (!In.Kept.Count || In.Kept.Period != Now ||
      !(__builtin_fabs(Compared - Threshold) <= 1.7976931348623157e308))
    return false;
  add(In, Bits, Compared, Threshold);
  return true;
}

/// At the first evaluation of \p S in a file of a ring, writes the outcome that
/// readers know: the files before may be gone. It is that of \p R, or if \p R
/// is a flop, the one before, with the values that it was last reported with.
/// \p Last is the last outcome. The site is locked.
void stateAgain(Thread &T, Site &S, const Report &R, int8_t Last);

/// Whether a slot in \p File is still to be taken.
bool holdsTouchedSlots(LogFile &File);

/// After this, each thread is seen inside its report, or sees what the calling
/// thread has stored.
void publishToThreads();

/// Call once in each process, before the first evaluation.
void prepareEdges();

/// Begins a new period and passes the summaries of the old one to \p S. With
/// \p All, also those of the period that has just begun; reports that arrive
/// meanwhile go into the next summaries.
void flushEdges(Sink &S, bool All);

} // namespace tpc

#endif // TPC_EDGES_H
