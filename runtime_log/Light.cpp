//===- Light.cpp ----------------------------------------------------------===//
#include "Light.h"

#include "Clock.h"
#include "Edges.h"
#include "Modes.h"
#include "Ros.h"
#include "Runtime.h"

#include <algorithm>
#include <cmath>
#include <sched.h>
#include <tuple>
#include <unordered_map>

namespace tpc {

/// So many evaluations of a site are inspected in a period before it is
/// sampled, and about so many samples are taken of a hot one.
static constexpr uint64_t Samples = 128;
/// While more are taken, the stride doubles after each so many.
static constexpr uint64_t SamplesOfStride = 32;
static constexpr uint64_t LongestStride = uint64_t(1) << 24;
/// How often a thread looks whether a site has become free: a few microseconds.
static constexpr int Looks = 200;

namespace {

/// The time when the current period began.
struct Beginning {
  std::atomic<int64_t> Steady{0}, Ros{0};
};
Beginning Began;

/// Counts down in one of the two words of a site.
class Countdown {
public:
  /// How many evaluations were passed over since the last call.
  uint64_t settle(const std::atomic<int32_t> &Left) {
    int32_t Now = std::max(0, Left.load(std::memory_order_relaxed));
    // A thread that had read the old value stored it, less one, after the
    // change.
    if (Now > Given)
      Given = std::max(Now, Replaced);
    uint64_t Passed = static_cast<uint64_t>(Given - Now);
    Given = Now;
    return Passed;
  }

  void set(std::atomic<int32_t> &Left, int32_t To) {
    Replaced = Given;
    Given = To;
    Left.store(To, std::memory_order_relaxed);
  }

private:
  int32_t Given = 0, Replaced = 0;
};

} // namespace

/// What `light` knows about a site.
struct LightSite {
  /// \p Module has the words of its key, if any.
  LightSite(Site &Of, SiteWords *Module, const void *Object)
      : Of(Of), Words(&Own), Module(Module), Object(Object) {
    clear();
    BeginSteady = Began.Steady.load(std::memory_order_relaxed);
    BeginRos = Began.Ros.load(std::memory_order_relaxed);
  }

  bool lock();
  void unlock() { Busy.store(false, std::memory_order_release); }

  /// Empties what is kept of a period.
  void clear();
  void settle();
  /// Goes on to count in \p To, from nothing; the site is locked.
  void goOnIn(SiteWords &To);
  uint64_t samples() const { return Kept.Count - Weighed.Count; }
  bool hasNews() const {
    return Kept.Flops || Turns || Whole.Unknown > 0 || ThresholdMoved ||
           Kept.Threshold != ToldThreshold;
  }
  /// Adds what came since the last time to Whole.
  void weigh();
  /// Ends a period; the site is locked.
  void endPeriod();
  /// One evaluation; the site is locked.
  void inspect(Thread &T, const Report &R);
  void inspectOutcome(Thread &T, const Report &R);
  void sample(const Report &R);
  void chooseNext(bool Result);
  void catchUp();
  uint64_t stride();
  /// The summary of the period that ends; the site is locked.
  Summary summary(int64_t EndSteady, int64_t EndRos);

  Site &Of;
  SiteWords Own = {};
  std::atomic<SiteWords *> Words; ///< in which it counts: Own or Module
  SiteWords *Module; ///< of its key; making() is held while it changes
  const void *const Object;
  std::atomic<bool> Busy{false};
  /// Evaluations that came while the site was in use.
  std::atomic<uint64_t> Unseen{0};

  // The rest is used while the site is locked.
  Countdown Counts[2];
  layout::Slot In = {}; ///< the sample
  layout::Summary &Kept = In.Kept;
  double Least, Most;    ///< of the compared values of the sample
  bool ThresholdMoved;   ///< within the sample
  uint64_t Passed;       ///< evaluations that were counted only
  uint64_t Blind;        ///< those of them between which flops are not seen
  uint64_t Pairs, Turns; ///< successive evaluations seen while blind, and flops
  uint64_t Before = 0;   ///< evaluations in the previous period
  /// Evaluations that are kept from before the current period: the last ones
  /// had no summary.
  uint64_t EarlierCount;
  /// What the sample says of all evaluations of the periods that ended and had
  /// one, Covered of them: each period is sampled as often as it needs, so each
  /// counts by its own share. Weighed is what was in the sample then.
  struct {
    uint64_t Covered;
    double Far, Odd, DiffSum, AbsSum, Unknown;
  } Whole;
  layout::Summary Weighed;
  double ToldThreshold = NAN; ///< in the last summary
  int64_t BeginSteady, BeginRos;
  uint32_t LastThread = 0;
  bool IsShared = false; ///< by several threads: some counts are lost
  bool IsBlind = false;  ///< flops are beyond the caps: they are sampled
  /// How the evaluation that is inspected next follows the last one.
  enum { Usual, AfterGap, OfPair } Next = Usual;
  int8_t Told = -1; ///< the outcome that was last reported
  uint32_t Random = 2463534242U;
};

bool LightSite::lock() {
  for (int Look = 0; Look < Looks; ++Look) {
    if (!Busy.exchange(true, std::memory_order_acquire))
      return true;
    while (Busy.load(std::memory_order_relaxed) && ++Look < Looks)
      __builtin_ia32_pause();
  }
  return false;
}

namespace {
struct Unlocker {
  LightSite &Of;
  ~Unlocker() { Of.unlock(); }
};
} // namespace

void LightSite::clear() {
  // What has no sample is told with the values of the last one.
  const layout::Summary Last = Kept;
  In = {};
  Kept.What = Last.What;
  Kept.Compared = Last.Compared;
  Kept.Threshold = Last.Threshold;
  Kept.DiffMin = Kept.Low = Least = HUGE_VAL;
  Kept.DiffMax = Kept.High = Most = -HUGE_VAL;
  Kept.Site = Of.Number;
  ThresholdMoved = false;
  Passed = Blind = Pairs = Turns = EarlierCount = 0;
  Whole = {};
  Weighed = Kept;
}

void LightSite::settle() {
  SiteWords *At = Words.load(std::memory_order_acquire);
  uint64_t More = Counts[0].settle(At->Left[0]) + Counts[1].settle(At->Left[1]);
  Passed += More;
  if (IsBlind)
    Blind += More;
}

void LightSite::goOnIn(SiteWords &To) {
  settle();
  Words.store(&To, std::memory_order_release);
  for (int Result = 0; Result < 2; ++Result)
    Counts[Result].set(To.Left[Result], 0);
}

/// How many evaluations to pass over until the next sample.
uint64_t LightSite::stride() {
  uint64_t Usual = Before / Samples;
  if (samples() < Samples && Usual < 2)
    return 0;
  uint64_t Doubled =
      samples() < Samples ? 0 : (samples() - Samples) / SamplesOfStride + 1;
  uint64_t Mean =
      std::min(std::max<uint64_t>(Usual, 1) << std::min<uint64_t>(Doubled, 24),
               LongestStride);
  // Not always the same number: a loop may have a rhythm.
  Random ^= Random << 13;
  Random ^= Random >> 17;
  Random ^= Random << 5;
  return Mean / 2 + Random % (Mean + 1);
}

void LightSite::chooseNext(bool Result) {
  SiteWords *At = Words.load(std::memory_order_acquire);
  bool IsHot = samples() >= Samples || Before / Samples >= 2;
  if (!IsBlind || !IsHot) {
    Next = Usual;
    Counts[Result].set(At->Left[Result], static_cast<int32_t>(stride()));
    Counts[!Result].set(At->Left[!Result], 0);
    return;
  }
  // In pairs, which say how often the outcome changes.
  Next = Next == AfterGap ? OfPair : AfterGap;
  auto Left = static_cast<int32_t>(Next == OfPair ? 0 : stride());
  Counts[0].set(At->Left[0], Left);
  Counts[1].set(At->Left[1], Left);
}

void LightSite::sample(const Report &R) {
  uint32_t Bits = layout::bits(R.Result, R.Outcome);
  if (Kept.Count && R.Threshold != Kept.Threshold)
    ThresholdMoved = true;
  if (std::isfinite(R.Compared - R.Threshold)) {
    Least = std::min(Least, R.Compared);
    Most = std::max(Most, R.Compared);
    add(In, Bits, R.Compared, R.Threshold);
    return;
  }
  ++Kept.Odd;
  Kept.Compared = R.Compared;
  Kept.Threshold = R.Threshold;
  Kept.What = layout::SummaryRecord | Bits;
  ++Kept.Count;
}

/// Reports the evaluation if it is the first one or a flop.
void LightSite::inspectOutcome(Thread &T, const Report &R) {
  int8_t Last = Of.Last.load(std::memory_order_relaxed);
  if (Next == OfPair) {
    ++Pairs;
    Turns += Last != R.Result;
  }
  if (isNewToRing(Of))
    stateAgain(T, Of, R, Last);
  if (Last == R.Result)
    return;
  Of.Last.store(R.Result ? 1 : 0, std::memory_order_relaxed);
  if (Next == AfterGap)
    return;
  bool IsFlop = Last >= 0;
  Kept.Flops += IsFlop;
  if (IsFlop && (Told == R.Result || isOverCap(Of, true))) {
    // Nobody has heard of the flop before, so this one is no news either.
    if (Told == R.Result) {
      Of.OverSiteCap.Count.fetch_add(1, std::memory_order_relaxed);
      Of.OverSiteCap.Flops.fetch_add(1, std::memory_order_relaxed);
    }
    IsBlind = true;
    return;
  }
  Told = R.Result;
  emit(T, Of, R, layout::EdgeBit);
  Of.Stated = {true, R.Result, R.Outcome, R.Compared, R.Threshold};
}

void LightSite::inspect(Thread &T, const Report &R) {
  settle();
  if (T.Number != LastThread) {
    IsShared |= LastThread != 0;
    LastThread = T.Number;
  }
  inspectOutcome(T, R);
  sample(R);
  chooseNext(R.Result);
}

/// If the last flops were beyond the caps, reports the outcome that they led
/// to.
void LightSite::catchUp() {
  int8_t Last = Of.Last.load(std::memory_order_relaxed);
  bool Result = (Kept.What & layout::ResultBit) != 0;
  if (Told < 0 || Told == Last || Last != Result)
    return;
  Thread *T = ThisThread ? ThisThread : makeThread();
  Told = Last;
  emit(*T, Of,
       {Of.Key.c_str(), Result, Kept.Compared, Kept.Threshold,
        (Kept.What & layout::OutcomeBit) != 0},
       layout::EdgeBit);
  Of.Stated = {true, Result, (Kept.What & layout::OutcomeBit) != 0,
               Kept.Compared, Kept.Threshold};
}

void LightSite::weigh() {
  const layout::Summary &K = Kept;
  if (Pairs) {
    Whole.Unknown += static_cast<double>(Blind) * static_cast<double>(Turns) /
                     static_cast<double>(Pairs);
    Blind = Pairs = Turns = 0;
  }
  const uint64_t Count = K.Count + Passed, Sampled = K.Count - Weighed.Count;
  if (!Sampled)
    return;
  auto Share =
      static_cast<double>(Count - Whole.Covered) / static_cast<double>(Sampled);
  Whole.Far += static_cast<double>(K.Far - Weighed.Far) * Share;
  Whole.Odd += static_cast<double>(K.Odd - Weighed.Odd) * Share;
  Whole.DiffSum += (K.DiffSum - Weighed.DiffSum) * Share;
  Whole.AbsSum += (K.AbsSum - Weighed.AbsSum) * Share;
  Whole.Covered = Count;
  Weighed = K;
}

Summary LightSite::summary(int64_t EndSteady, int64_t EndRos) {
  weigh();
  const layout::Summary &K = Kept;
  uint64_t Count = K.Count + Passed;
  bool IsUsable = K.Count > K.Odd;
  double Share = Whole.Covered ? static_cast<double>(Count) /
                                     static_cast<double>(Whole.Covered)
                               : 1;
  auto Scaled = [&](double N) {
    return static_cast<uint64_t>(std::llround(N * Share));
  };
  auto Unknown = static_cast<uint64_t>(std::llround(Whole.Unknown));
  Summary S{};
  S.Key = Of.Key.c_str();
  S.Site = Of.Number;
  S.Result = (K.What & layout::ResultBit) != 0;
  S.Outcome = (K.What & layout::OutcomeBit) != 0;
  S.Compared = K.Compared;
  S.Threshold = K.Threshold;
  S.Count = Count;
  S.Flops = K.Flops + Unknown;
  S.Far = std::min(Scaled(Whole.Far), Count);
  S.Odd = IsUsable ? std::min(Scaled(Whole.Odd), Count) : Count;
  S.DiffMin = K.DiffMin;
  S.DiffMax = K.DiffMax;
  S.DiffSum = Passed ? Whole.DiffSum * Share : K.DiffSum;
  S.AbsSum = Passed ? Whole.AbsSum * Share : K.AbsSum;
  S.Low = K.Low;
  S.High = K.High;
  S.BeginSteady = BeginSteady;
  S.EndSteady = EndSteady;
  S.BeginRos = BeginRos;
  S.EndRos = EndRos;
  S.Seen = K.Count;
  S.IsLight = true;
  S.IsAbout = IsShared || Unknown;
  S.HasOneThreshold = !ThresholdMoved;
  S.Least = Least;
  S.Most = Most;
  if (Unknown) {
    Of.OverSiteCap.Count.fetch_add(Unknown, std::memory_order_relaxed);
    Of.OverSiteCap.Flops.fetch_add(Unknown, std::memory_order_relaxed);
  }
  return S;
}

//===----------------------------------------------------------------------===//
// In the reporting threads
//===----------------------------------------------------------------------===//

/// Guards the creation of sites, and what modules have registered.
static std::mutex &making() {
  static auto *Lock = new std::mutex;
  return *Lock;
}

/// The sites that count in the words of their module.
static std::unordered_map<SiteWords *, LightSite *> &owners() {
  static auto *All = new std::unordered_map<SiteWords *, LightSite *>;
  return *All;
}

static LightSite &lightOf(Site &S, const char *Key, const void *Object) {
  if (LightSite *L = S.Light.load(std::memory_order_acquire))
    return *L;
  std::lock_guard<std::mutex> Guard(making());
  LightSite *L = S.Light.load(std::memory_order_relaxed);
  if (!L) {
    L = new LightSite(S, wordsOf(Key), Object);
    if (L->Module && owners().try_emplace(L->Module, L).second) {
      L->Words = L->Module;
      L->Module->Object = Object;
    }
    S.Light.store(L, std::memory_order_release);
  }
  return *L;
}

void light(Thread &T, Site &S, const Report &R, const char *Key,
           const void *Object) {
  LightSite &L = lightOf(S, Key, Object);
  if (!L.lock()) {
    L.Unseen.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  Unlocker Guard{L};
  L.inspect(T, R);
}

bool isPassedOver(const Site &S, bool Result) {
  LightSite *L = S.Light.load(std::memory_order_acquire);
  // A module that has the words has looked at them already.
  if (!L || L->Words.load(std::memory_order_relaxed) != &L->Own)
    return false;
  std::atomic<int32_t> &Left = L->Own.Left[Result];
  int32_t Now = Left.load(std::memory_order_relaxed);
  if (Now > 0)
    Left.store(Now - 1, std::memory_order_relaxed);
  return Now != 0;
}

//===----------------------------------------------------------------------===//
// In the helper thread
//===----------------------------------------------------------------------===//

static int64_t rosTime() {
  return TimeIsSimulated.load(std::memory_order_relaxed) ? rosNow()
                                                         : Clock::real();
}

template <typename F> static void forEachLight(F Visit) {
  for (uint32_t Number = 1; Number <= sites().size(); ++Number)
    if (LightSite *L = sites()[Number].Light.load(std::memory_order_acquire))
      Visit(*L);
}

void beginLight(bool Forgets) {
  Began.Steady = Clock::now();
  Began.Ros = rosTime();
  forEachLight([&](LightSite &L) {
    if (!L.lock())
      return;
    Unlocker Guard{L};
    L.Told = -1;
    if (!Forgets)
      return;
    L.settle();
    L.clear();
    L.BeginSteady = Began.Steady;
    L.BeginRos = Began.Ros;
  });
}

void lookAgain() {
  forEachLight([](LightSite &L) {
    // If it is in use, it is inspected now; its outcome is said later.
    if (!L.lock())
      return;
    Unlocker Guard{L};
    L.settle();
    SiteWords *At = L.Words.load(std::memory_order_relaxed);
    for (int Result = 0; Result < 2; ++Result)
      L.Counts[Result].set(At->Left[Result], 0);
  });
}

void LightSite::endPeriod() {
  settle();
  Passed += Unseen.exchange(0, std::memory_order_relaxed);
  const uint64_t Count = Kept.Count + Passed;
  Before = Count - EarlierCount;
  weigh();
  EarlierCount = Count;
  IsBlind = false;
  if (!Before)
    return;
  // The next period is sampled from its beginning if the countdown would not
  // end in it.
  SiteWords *At = Words.load(std::memory_order_relaxed);
  for (int Result = 0; Result < 2; ++Result)
    if (static_cast<uint64_t>(std::max(0, At->Left[Result].load())) * 2 >
        Before)
      Counts[Result].set(At->Left[Result], 0);
  Next = Usual;
}

void releaseWords(const Site &S) {
  LightSite *L = S.Light.load(std::memory_order_acquire);
  if (!L)
    return;
  std::lock_guard<std::mutex> Guard(making());
  auto Owner = L->Module ? owners().find(L->Module) : owners().end();
  if (Owner != owners().end() && Owner->second == L)
    L->Module->Object = nullptr;
}

/// Hands the words of a module to \p L if it was evaluated far more often in
/// the last period than the object that has them.
static void handWordsTo(LightSite &L) {
  constexpr uint64_t Hot = 10000, Margin = 2;
  if (L.Before < Hot || L.Words.load() != &L.Own)
    return;
  std::lock_guard<std::mutex> Guard(making());
  auto Owner = L.Module ? owners().find(L.Module) : owners().end();
  if (Owner == owners().end() || L.Before < Owner->second->Before * Margin)
    return;
  LightSite &Now = *Owner->second;
  // If one of them is in use, it is hot in the next period as well.
  if (!Now.lock())
    return;
  Unlocker First{Now};
  if (!L.lock())
    return;
  Unlocker Second{L};
  Now.goOnIn(Now.Own);
  L.Module->Object = L.Object;
  L.goOnIn(*L.Module);
  Owner->second = &L;
}

namespace {
/// A site that has something to summarise.
struct Waiting {
  LightSite *Of;
  bool IsNews, IsOld;
  int64_t Since;

  /// What comes first is smaller.
  std::tuple<bool, bool, int64_t, uint32_t> urgency() const {
    return {!IsOld, !IsOld && !IsNews, Since, Of->Of.Number};
  }
};
} // namespace

/// Ends the period of all sites, and returns those that have a sample; with
/// \p IsEnd, also those that have none.
static std::vector<Waiting> endPeriods(int64_t Steady, int64_t Ros, bool IsEnd,
                                       const SummaryLimit &Limit) {
  std::vector<Waiting> Found;
  forEachLight([&](LightSite &L) {
    // If it is in use, its period becomes longer.
    if (!L.lock())
      return;
    Unlocker Guard{L};
    L.endPeriod();
    if (!L.EarlierCount) {
      L.BeginSteady = Steady;
      L.BeginRos = Ros;
    } else if (L.Kept.Count || IsEnd) {
      Found.push_back({&L, L.hasNews(),
                       Steady - L.BeginSteady >= Limit.OldestNs,
                       L.BeginSteady});
    }
  });
  return Found;
}

void flushLight(Sink &To, bool IsEnd, const SummaryLimit &Limit) {
  int64_t Steady = Clock::now(), Ros = rosTime();
  std::vector<Waiting> Found = endPeriods(Steady, Ros, IsEnd, Limit);
  if (!IsEnd && Found.size() > Limit.Most) {
    std::sort(Found.begin(), Found.end(),
              [](const Waiting &A, const Waiting &B) {
                return A.urgency() < B.urgency();
              });
    Found.resize(Limit.Most);
  }
  // Those of one span follow each other.
  std::sort(Found.begin(), Found.end(), [](const Waiting &A, const Waiting &B) {
    return std::make_pair(A.Since, A.Of->Of.Number) <
           std::make_pair(B.Since, B.Of->Of.Number);
  });
  for (const Waiting &W : Found) {
    LightSite &L = *W.Of;
    Summary S;
    {
      if (!L.lock())
        continue;
      Unlocker Guard{L};
      L.settle();
      S = L.summary(Steady, Ros);
      L.catchUp();
      L.ToldThreshold = L.Kept.Threshold;
      L.clear();
      L.BeginSteady = Steady;
      L.BeginRos = Ros;
    }
    To.take(S);
  }
  forEachLight(handWordsTo);
  Began.Steady = Steady;
  Began.Ros = Ros;
}

void lightAfterFork() {
  new (&making()) std::mutex;
  forEachLight([](LightSite &L) {
    L.Busy = false;
    L.Unseen = 0;
    L.settle();
    L.clear();
    SiteWords *At = L.Words.load();
    for (int Result = 0; Result < 2; ++Result)
      L.Counts[Result].set(At->Left[Result], 0);
    L.Told = -1;
    L.Before = 0;
    L.LastThread = 0;
    L.IsShared = L.IsBlind = false;
    L.Next = LightSite::Usual;
  });
}

//===----------------------------------------------------------------------===//
// Modules
//===----------------------------------------------------------------------===//

namespace {
struct Module {
  SiteWords *First;
  uint64_t Count;
};

std::vector<Module> &modules() {
  static auto *All = new std::vector<Module>;
  return *All;
}
} // namespace

/// making() is held.
SiteWords *wordsOf(const char *Key) {
  for (const Module &M : modules()) {
    auto At = reinterpret_cast<uintptr_t>(Key);
    auto First = reinterpret_cast<uintptr_t>(M.First);
    if (At < First || At >= First + M.Count * sizeof(SiteWords))
      continue;
    SiteWords *Found = M.First + (At - First) / sizeof(SiteWords);
    return Found->Key == Key ? Found : nullptr;
  }
  return nullptr;
}

} // namespace tpc

using namespace tpc;

void tpc_register_sites(SiteWords *First, uint64_t Count) {
  std::lock_guard<std::mutex> Guard(making());
  modules().push_back({First, Count});
}

void tpc_forget_sites(SiteWords *First) {
  std::lock_guard<std::mutex> Guard(making());
  auto Found = std::find_if(modules().begin(), modules().end(),
                            [&](const Module &M) { return M.First == First; });
  if (Found == modules().end())
    return;
  SiteWords *End = First + Found->Count;
  modules().erase(Found);
  if (!TheSites)
    return;
  forEachLight([&](LightSite &L) {
    if (L.Module < First || L.Module >= End)
      return;
    owners().erase(L.Module);
    // The helper thread holds the lock for a moment only.
    while (!L.lock())
      sched_yield();
    Unlocker Guard{L};
    if (L.Words.load() != &L.Own)
      L.goOnIn(L.Own);
    L.Module = nullptr;
  });
}
