//===- Edges.cpp ----------------------------------------------------------===//
#include "Edges.h"

#include "Clock.h"
#include "Modes.h"
#include "Ros.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <linux/membarrier.h>
#include <sched.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace tpc {

using layout::Slot;

static constexpr int64_t Patience = 100'000'000;

namespace {

/// The time when a period began.
struct Beginning {
  int64_t Steady, Ros;
};

} // namespace

std::atomic<LogFile *> SlotsHome{nullptr};
std::atomic<uint32_t> NowPeriod{1};
static Beginning Beginnings[4];
static std::mutex Flushing;
static bool HasBarrier = false;

static int64_t rosTime() {
  return TimeIsSimulated.load(std::memory_order_relaxed) ? rosNow()
                                                         : Clock::real();
}

//===----------------------------------------------------------------------===//
// In the reporting threads
//===----------------------------------------------------------------------===//

/// Makes two slots for a site that is new to the thread, or after the sink
/// changed. Slots in the file can be read even if the process is killed.
static void makePair(Thread &T, const Site &S) {
  LogFile *File = SlotsHome.load(std::memory_order_acquire);
  if (T.PairsHome.load(std::memory_order_relaxed) != File) {
    // The helper thread takes the contents of the old slots.
    std::fill(T.Pairs, T.Pairs + T.PairCount, nullptr);
    T.PairsHome.store(File, std::memory_order_relaxed);
  }
  if (S.Number > T.PairCount) {
    uint32_t Count = std::max<uint32_t>(64, T.PairCount * 2);
    while (Count < S.Number)
      Count *= 2;
    auto **Pairs = new SlotPair *[Count]();
    std::copy(T.Pairs, T.Pairs + T.PairCount, Pairs);
    delete[] T.Pairs;
    T.Pairs = Pairs;
    T.PairCount = Count;
  }
  SlotPair *Pair = File ? File->newPair(T) : nullptr;
  if (!Pair)
    Pair = new SlotPair();
  T.Pairs[S.Number - 1] = Pair;
}

static Summary summaryOf(const layout::Summary &K) {
  return {sites()[K.Site].Key.c_str(),
          K.Site,
          K.Thread,
          K.Period,
          (K.What & layout::ResultBit) != 0,
          (K.What & layout::OutcomeBit) != 0,
          K.Compared,
          K.Threshold,
          K.Count,
          K.Flops,
          K.Far,
          K.Odd,
          K.DiffMin,
          K.DiffMax,
          K.DiffSum,
          K.AbsSum,
          K.Low,
          K.High,
          K.BeginSteady,
          K.EndSteady,
          K.BeginRos,
          K.EndRos};
}

/// Passes the summary of a slot to the sink and empties the slot.
static void take(Slot &From, Sink &To, int64_t EndSteady, int64_t EndRos) {
  layout::Summary &K = From.Kept;
  if (!K.Count)
    return;
  K.EndSteady = EndSteady;
  K.EndRos = EndRos;
  To.take(summaryOf(K));
  K.Count = From.Begun = 0;
}

/// Begins a slot that is empty, or belongs to an earlier period.
static void beginSlot(Thread &T, const Site &S, Slot &In, uint32_t Now) {
  std::lock_guard<std::mutex> Guard(T.Lock);
  layout::Summary &K = In.Kept;
  // This thread stopped inside an old period for so long that the helper
  // continued without it.
  take(In, summarySink(), Clock::now(), rosTime());
  const Beginning &B = Beginnings[Now & 3];
  K = {};
  In.Begun = 0;
  K.Site = S.Number;
  K.Period = Now;
  K.Thread = T.Number;
  K.BeginSteady = B.Steady;
  K.BeginRos = B.Ros;
  K.DiffMin = K.Low = HUGE_VAL;
  K.DiffMax = K.High = -HUGE_VAL;
  T.Touched[Now & 1].push_back(&In);
}

/// Reports a flop if the outcome of the predicate differs from the last one.
static void edge(Thread &T, Site &S, Slot &In, const Report &R) {
  std::lock_guard<std::mutex> Guard(S.Lock);
  int8_t Last = S.Last.load(std::memory_order_relaxed);
  stateAgain(T, S, R, Last);
  if (Last == R.Result)
    return; // another thread was first, or the file is new
  S.Last.store(R.Result ? 1 : 0, std::memory_order_relaxed);
  bool IsFlop = Last >= 0;
  In.Kept.Flops += IsFlop;
  if (isOverCap(S, IsFlop))
    return;
  // Under the lock, so that flops are recorded in the order in which they
  // happened.
  emit(T, S, R, layout::EdgeBit);
  S.Stated = {true, R.Result, R.Outcome, R.Compared, R.Threshold};
}

void stateAgain(Thread &T, Site &S, const Report &R, int8_t Last) {
  LogFile *File = RingRuns.load() ? NowFile.load() : nullptr;
  if (!File || Last < 0 || S.StatedIn.load(std::memory_order_relaxed) == File)
    return;
  auto &Stated = S.Stated;
  if (Last == R.Result && (!Stated.IsKnown || Stated.Result == R.Result))
    Stated = {true, R.Result, R.Outcome, R.Compared, R.Threshold};
  if (Stated.IsKnown)
    File->write(T, S,
                layout::EdgeBit | layout::bits(Stated.Result, Stated.Outcome),
                Stated.Compared, Stated.Threshold);
  S.StatedIn.store(File, std::memory_order_relaxed);
}

void edges(Thread &T, Site &S, const Report &R) {
  if (S.Number > T.PairCount || !T.Pairs[S.Number - 1] ||
      T.PairsHome.load(std::memory_order_relaxed) !=
          SlotsHome.load(std::memory_order_relaxed))
    makePair(T, S);
  uint32_t Now = NowPeriod.load(std::memory_order_acquire);
  Slot &In = T.Pairs[S.Number - 1]->Of[Now & 1];
  layout::Summary &K = In.Kept;
  if (!K.Count || K.Period != Now)
    beginSlot(T, S, In, Now);
  if (S.Last.load(std::memory_order_relaxed) != R.Result || isNewToRing(S))
    edge(T, S, In, R);
  uint32_t Bits = layout::bits(R.Result, R.Outcome);
  if (std::isfinite(R.Compared - R.Threshold)) {
    add(In, Bits, R.Compared, R.Threshold);
    return;
  }
  ++In.Begun;
  ++K.Odd;
  K.Compared = R.Compared;
  K.Threshold = R.Threshold;
  K.What = layout::SummaryRecord | Bits;
  std::atomic_signal_fence(std::memory_order_release);
  ++K.Count;
}

//===----------------------------------------------------------------------===//
// In the helper thread
//===----------------------------------------------------------------------===//

void prepareEdges() {
  HasBarrier =
      !syscall(SYS_membarrier, MEMBARRIER_CMD_REGISTER_PRIVATE_EXPEDITED, 0, 0);
  Beginning &B = Beginnings[NowPeriod.load() & 3];
  if (!B.Steady)
    B = {Clock::steady(), rosTime()};
}

static void sleepMs(long Ms) {
  timespec T{0, Ms * 1'000'000};
  nanosleep(&T, nullptr);
}

void publishToThreads() {
  if (!HasBarrier ||
      syscall(SYS_membarrier, MEMBARRIER_CMD_PRIVATE_EXPEDITED, 0, 0))
    sleepMs(1);
}

bool holdsTouchedSlots(LogFile &File) {
  for (Thread *T : allThreads()) {
    std::lock_guard<std::mutex> Guard(T->Lock);
    for (const std::vector<Slot *> &Touched : T->Touched)
      for (const Slot *In : Touched)
        if (File.holds(In))
          return true;
  }
  return false;
}

/// Waits until no thread is inside the old period. Leaves out threads that take
/// longer than the patience: their slots are taken later.
static std::vector<Thread *> withoutLate(std::vector<Thread *> Threads) {
  // A thread marks itself as inside by a plain store before it reads the
  // period. The barrier makes either this store visible here, or the new period
  // there.
  publishToThreads();
  int64_t Until = Clock::steady() + Patience;
  auto IsLate = [&](Thread *T) {
    uint32_t Seen = T->Inside.load(std::memory_order_acquire);
    if (!(Seen & 1) || T == ThisThread)
      return false;
    for (int Try = 0; T->Inside.load(std::memory_order_acquire) == Seen;
         ++Try) {
      if (Clock::steady() > Until)
        return true;
      if (Try < 100)
        sched_yield();
      else
        sleepMs(1);
    }
    return false;
  };
  Threads.erase(std::remove_if(Threads.begin(), Threads.end(), IsLate),
                Threads.end());
  return Threads;
}

static void flushPeriod(Sink &S) {
  uint32_t Old = NowPeriod.load(std::memory_order_relaxed);
  Beginnings[(Old + 1) & 3] = {Clock::now(), rosTime()};
  NowPeriod.store(Old + 1, std::memory_order_seq_cst);
  std::vector<Thread *> Threads = withoutLate(allThreads());
  int64_t EndSteady = Clock::now(), EndRos = rosTime();
  std::vector<Slot *> Touched;
  for (Thread *T : Threads) {
    Touched.clear();
    {
      std::lock_guard<std::mutex> Guard(T->Lock);
      Touched.swap(T->Touched[Old & 1]);
    }
    for (Slot *In : Touched)
      take(*In, S, EndSteady, EndRos);
    Touched.clear();
    // The space is reused.
    std::lock_guard<std::mutex> Guard(T->Lock);
    if (T->Touched[Old & 1].empty())
      Touched.swap(T->Touched[Old & 1]);
  }
}

void flushEdges(Sink &S, bool All) {
  std::lock_guard<std::mutex> Guard(Flushing);
  flushPeriod(S);
  if (All)
    flushPeriod(S);
}

} // namespace tpc
