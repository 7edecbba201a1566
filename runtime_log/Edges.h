//===- Edges.h - The policy `edges` ---------------------------------------===//
//
// Each flop is reported, and of all evaluations a summary is kept for each
// site, thread and period. A thread adds to its own slots without a lock, those
// of even and odd periods in turn; the helper thread begins a new period, waits
// until no thread is still inside of the old one, and takes its slots.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_EDGES_H
#define TPC_EDGES_H

#include "Sink.h"
#include "Sites.h"
#include "Threads.h"

namespace tpc {

/// The file that slots are in, where that is the sink; else null.
extern std::atomic<LogFile *> SlotsHome;

/// The period that has begun last.
extern std::atomic<uint32_t> NowPeriod;

/// |compared - threshold| above which an evaluation is far
/// (docs/reference/runtime.md).
constexpr double FarFrom = 1e-4;

template <typename T> inline void setIf(bool Changes, T &To, T Value) {
  if (__builtin_expect(Changes, 0)) {
    To = Value;
    asm volatile("" ::: "memory"); // a branch, and no store of what was there
  }
}

/// Adds one evaluation of usual values to a slot. \p Bits are those of the
/// outcomes.
inline void add(layout::Slot &To, uint32_t Bits, double Compared,
                double Threshold) {
  layout::Summary &K = To.Kept;
  // Begun and Count tell a reader of the file whether the process ended in
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
  // These seldom change, and not to write is cheaper than to write.
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

/// Takes in one evaluation.
void edges(Thread &T, Site &S, const Report &R);

/// The same where it is no flop and nothing else stands in the way; else does
/// nothing and returns false.
inline bool edgesAtOnce(Thread &T, const Site &S, bool Result, uint32_t Bits,
                        double Compared, double Threshold) {
  if (S.Number > T.PairCount ||
      T.PairsHome != SlotsHome.load(std::memory_order_relaxed) ||
      S.Last.load(std::memory_order_relaxed) != Result)
    return false;
  SlotPair *Pair = T.Pairs[S.Number - 1];
  if (!Pair)
    return false;
  uint32_t Now = NowPeriod.load(std::memory_order_acquire);
  layout::Slot &In = Pair->Of[Now & 1];
  // (Also false with what is no number.)
  if (!In.Kept.Count || In.Kept.Period != Now ||
      !(__builtin_fabs(Compared - Threshold) <= 1.7976931348623157e308))
    return false;
  add(In, Bits, Compared, Threshold);
  return true;
}

/// Once in each process, before the first evaluation.
void prepareEdges();

/// Begins a new period and gives the summaries of the old one to \p S; with
/// \p All those of a period that has just begun, too (no reports are expected
/// meanwhile, or they come into the next summaries).
void flushEdges(Sink &S, bool All);

} // namespace tpc

#endif // TPC_EDGES_H
