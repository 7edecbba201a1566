//===- Runtime.cpp - The chosen settings, and the helper thread -----------===//
#include "Runtime.h"

#include "Edges.h"
#include "Light.h"
#include "Modes.h"
#include "ReadNames.h"
#include "Ring.h"
#include "Ros.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <unistd.h>
#include <utility>

namespace tpc {

static constexpr int64_t Second = 1'000'000'000;
static constexpr int64_t PollNs = 20'000'000;
static constexpr int64_t Never = INT64_MAX;
/// Until then the rate of the counter is not known well enough to use it.
static constexpr int64_t FirstAdjustNs = 10'000'000;
static constexpr int64_t Jump = 1'000'000;
/// What `light` sends of summaries, of about 100 bytes each.
static constexpr uint64_t SummariesOfSecond = 120;
/// Nothing is new about a site for so many periods: it comes next all the same.
static constexpr int64_t PeriodsOfQuiet = 16;
/// If simulated time is faster than this, what `light` may send does not become
/// more any more.
static constexpr int64_t FastestClock = 10;

//===----------------------------------------------------------------------===//
// The state that log_one reads
//===----------------------------------------------------------------------===//

std::atomic<Mode> NowMode{Mode::NotStarted};
std::atomic<LogFile *> NowFile{nullptr};
std::atomic<Sink *> NowSink{nullptr};
std::atomic<bool> ReportsToFile{false};
std::atomic<bool> RingRuns{false};
Sites *TheSites = nullptr;
std::atomic<uint64_t> SiteCap{0}, ProcessCap{0};
Meter ProcessMeter;
FairMeter FairProcessMeter;

namespace {

/// Represents the file among the sinks.
class FileSink final : public Sink {
public:
  /// log_one writes these itself, unless the file was chosen this moment.
  void take(const Report &R) override {
    Site *S = sites().find(R.Key);
    if (LogFile *F = NowFile.load(); F && S && ThisThread)
      F->write(*ThisThread, *S, edgeBit() | layout::bits(R.Result, R.Outcome),
               R.Compared, R.Threshold);
  }
  void take(const Summary &S) override {
    LogFile *F = NowFile.load();
    if (!F)
      return;
    F->announce(sites()[S.Site]);
    F->write(S);
  }
  void take(const Dropped &D) override {
    LogFile *F = NowFile.load();
    if (!F)
      return;
    if (D.Site)
      F->announce(sites()[D.Site]);
    F->write(D);
  }
  void take(const ReadName &N) override {
    if (LogFile *F = NowFile.load())
      F->write(N);
  }
  bool forgets() const override { return false; }
};

/// The chosen sink, with the ring beside it. Reports take the way of emit().
class BesideSink final : public Sink {
public:
  void take(const Report &R) override { chosen().take(R); }
  void take(const Summary &S) override { both(S); }
  void take(const Dropped &D) override { both(D); }
  void take(const ReadName &N) override { both(N); }
  bool forgets() const override { return chosen().forgets(); }

private:
  static Sink &chosen() { return *NowSink.load(); }
  template <typename What> void both(const What &W) {
    chosen().take(W);
    File.take(W);
  }

  FileSink File;
};

class NoSink final : public Sink {
public:
  void take(const Report &) override {}
  void take(const Summary &) override {}
  void take(const Dropped &) override {}
};

/// Everything that seldom changes, and the helper thread.
class Runtime {
public:
  static Runtime &of() {
    static auto *R = new Runtime;
    return *R;
  }

  void start();
  bool apply(const Config &Wanted);
  Config current();
  std::string status();
  void wake();
  void end();

  void beforeFork();
  void afterFork(bool IsChild);

private:
  Runtime();

  static Sink &sinkOf(SinkKind K);
  LogFile *openFile(const Config &C);
  LogFile *fileInUse() const;
  void turnRing(int64_t Now);
  Config possible(const Config &C);
  void tellOfFile();
  bool choose(const Config &C);
  bool isSummarised() const;
  void flush(bool IsEnd);
  int64_t periodNs() const;
  void followClock();
  void setCaps(const Config &C);
  void startHelper();
  void help();
  int64_t runDue(int64_t Now);
  void eachSecond();
  void accountForDrops();
  void giveLate();

  /// Taken before Changing. The threads whose first reports come while the
  /// runtime starts wait for this one only: the helper thread waits, with
  /// Changing locked, for threads that are inside a report.
  std::mutex Starting;
  std::mutex Changing;      ///< for everything that follows
  Sink *Left = nullptr;     ///< because its ROS cannot be used
  Config Held;              ///< as it was set
  Config Filled;            ///< what holds
  bool IsStarted = false;   ///< changes while both are locked
  bool HasSettings = false; ///< Held was read or set, perhaps before a fork
  /// The process may end in one thread while another one starts the helper.
  std::atomic<bool> HelperRuns{false};
  pthread_t Helper{};

  // No lock: roscpp's threads wake the helper, and a signal handler may have
  // interrupted a thread that does, and now wait for roscpp's threads.
  sem_t Wake; ///< posted once IsAwake or IsEnding is set
  std::atomic<bool> IsAwake{false};
  std::atomic<bool> IsEnding{false};

  // Used by the helper only.
  int64_t NextRos = 0, NextPoll = 0, NextPeriod = 0, NextSecond = 0;
  int64_t RealOffset = 0;
  /// The last reading of the steady time and of the simulated one.
  int64_t LastSteady = 0, LastRos = 0;
  /// Nanoseconds of real time in a second of the robot's clock.
  int64_t ClockSecond = Second;
  bool HasToldOfCaps = false;
  bool HasToldOfFile = false; ///< while Changing is locked
  bool HasToldOfRing = false; ///< the same
  Ring Segments;              ///< the same
  int64_t NextSegment = 0;    ///< not before, if one could not be begun
  std::atomic<uint64_t> DroppedInAll{0};
};

Runtime::Runtime() {
  // Never destroyed, like this object: threads report until the process ends.
  TheSites = new Sites;
  sem_init(&Wake, 0, 0);
  pthread_atfork([] { of().beforeFork(); }, [] { of().afterFork(false); },
                 [] { of().afterFork(true); });
  // Handlers run in the reverse order of their registration, so this one runs
  // before anything that exists now is destroyed.
  std::atexit([] { of().end(); });
}

Sink &Runtime::sinkOf(SinkKind K) {
  static auto *File = new FileSink;
  static auto *None = new NoSink;
  switch (K) {
  case SinkKind::Auto:
    return autoSink();
  case SinkKind::Rosout:
    return rosoutSink();
  case SinkKind::Topic:
    return topicSink();
  case SinkKind::File:
    return *File;
  case SinkKind::Off:
    return *None;
  }
  return *None;
}

void Runtime::start() {
  std::lock_guard<std::mutex> GuardOfStart(Starting);
  if (IsStarted)
    return;
  std::lock_guard<std::mutex> Guard(Changing);
  TimeIsSimulated = rosTimeIsSimulated();
  prepareEdges();
  // A forked child keeps the settings of its parent, and its clock.
  if (!HasSettings) {
    // Not in the helper: a fork waits for this lock, so it never comes in
    // between.
    Clock::prepare();
    Held = configOfEnvironment();
  }
  HasSettings = true;
  Held = possible(Held);
  if (!choose(Held)) {
    // The warning has been given; a ROS parameter may name another folder.
    Held.Sink = SinkKind::Off;
    choose(Held);
  }
  tellOfFile();
  // Only now: if memory ran out, the next report tries again.
  IsStarted = true;
  // The topics of a child that was forked from a node reach nobody, so there is
  // nothing to do. A thread that ends makes glibc unmap the stacks of the
  // threads that are missing in the child, and the libraries of ROS, at their
  // end, look for their threads there.
  if (fileInUse() || !forkedFromNode())
    startHelper();
}

/// \p C, but with the file in place of a topic of a ROS that cannot be used:
/// reports are not lost, and there are no more of them.
Config Runtime::possible(const Config &C) {
  if (C.Sink == SinkKind::File || C.Sink == SinkKind::Off || whyNoRos().empty())
    return C;
  Config InFile = C;
  InFile.Policy = C.filledIn().Policy;
  InFile.Sink = SinkKind::File;
  return InFile;
}

/// Says once that the file has what a topic was to get.
void Runtime::tellOfFile() {
  const std::string Why = whyNoRos();
  LogFile *F = Held.Sink == SinkKind::File ? NowFile.load() : nullptr;
  if (Why.empty() || !F || std::exchange(HasToldOfFile, true))
    return;
  warn("no reports are sent on a topic (" + Why + "); they are written to " +
       F->path().substr(0, F->path().rfind('/')));
}

/// Makes log_one follow \p C; false if its file cannot be created.
bool Runtime::choose(const Config &C) {
  const bool HasRing = C.hasRing() && C.Sink != SinkKind::Off;
  if (C.Sink == SinkKind::File || HasRing) {
    if (LogFile *F = NowFile.load(); !F || F->isStopped()) {
      if (LogFile *File = openFile(C)) {
        if (LogFile *Old = NowFile.exchange(File); Old && HasRing)
          Segments.leave(*Old, Clock::steady());
        else if (Old)
          Old->close();
        ReadNames::all().startAgain();
      } else if (C.Sink == SinkKind::File) {
        return false;
      }
    }
    if (LogFile *F = NowFile.load())
      F->writePolicy(C.filledIn());
  }
  Filled = C.filledIn();
  setCaps(C);
  ReportsToFile = C.Sink == SinkKind::File;
  RingRuns = HasRing;
  SlotsHome = ReportsToFile || HasRing ? NowFile.load() : nullptr;
  Sink *Old = NowSink.exchange(&sinkOf(C.Sink));
  bool IsCapped = SiteCap || ProcessCap;
  bool IsLight = Filled.Policy == Policy::Light && C.Sink != SinkKind::Off;
  // What was evaluated since the flush is still to be told.
  if (IsLight)
    beginLight(/*Forgets=*/NowMode.load() != Mode::Light);
  NowMode = C.Sink == SinkKind::Off          ? Mode::Off
            : IsLight                        ? Mode::Light
            : Filled.Policy == Policy::Edges ? Mode::Edges
            : C.Sink == SinkKind::File
                ? (IsCapped ? Mode::Capped : Mode::FileEvery)
            : IsCapped ? Mode::Capped
                       : Mode::SinkEvery;
  tpc_reporting = C.Sink == SinkKind::Off ? ReportNone
                  : IsLight               ? ReportFew
                                          : ReportAll;
  if (!Old || Old == NowSink.load())
    return true;
  if (C.Sink == SinkKind::File && !whyNoRos().empty())
    (Left = Old)->giveTo(*NowFile.load());
  else
    Old->end();
  return true;
}

/// A new file, of the ring if there is one; null if that fails, with a warning.
LogFile *Runtime::openFile(const Config &C) {
  std::string Why;
  LogFile *File = C.hasRing() ? Segments.next(C, NowFile.load(), Why)
                              : LogFile::open(C, nullptr, Why);
  if (!File)
    warn(Why + "; no reports are written to a file");
  HasToldOfRing = !File;
  return File;
}

/// The file that reports go to, as the chosen sink or beside it.
LogFile *Runtime::fileInUse() const {
  return ReportsToFile || RingRuns ? NowFile.load() : nullptr;
}

/// Begins the next file of the ring if it is time.
void Runtime::turnRing(int64_t Now) {
  constexpr int64_t AgainNs = 10 * Second;
  if (!RingRuns)
    return;
  Segments.settle(Held, Now);
  LogFile *Old = NowFile.load();
  if (Now < NextSegment || (Old && !Segments.isDue(Held, *Old, Now)))
    return;
  const bool HasRoom = Segments.makeRoom(Held, Old);
  // A thread that waits for a processor goes on soon.
  if (!HasRoom && Now - Segments.heldSince() < Second) {
    NextSegment = Now + PollNs;
    return;
  }
  // The slots of this period are in the old file.
  if (HasRoom && Filled.Policy == Policy::Edges)
    flush(/*IsEnd=*/true);
  std::string Why;
  LogFile *New = Segments.next(Held, Old, Why);
  if (!New) {
    NextSegment = Now + (HasRoom ? AgainNs : Second);
    if (!std::exchange(HasToldOfRing, true))
      warn(Why + (HasRoom ? "; the ring stops until a file can be written"
                          : "; no further file is begun until it can"));
    return;
  }
  HasToldOfRing = false;
  New->writePolicy(Filled);
  NowFile = New;
  SlotsHome = New;
  ReadNames::all().startAgain();
  if (Filled.Policy == Policy::Light)
    lookAgain();
  // Not Now: a new file may take its time, and reports go to the old one.
  if (Old)
    Segments.leave(*Old, Clock::steady());
}

bool Runtime::apply(const Config &Wanted) {
  start();
  std::lock_guard<std::mutex> Guard(Changing);
  const Config C = possible(Wanted);
  if (C == Held)
    return true;
  // What the policy has kept so far goes to the old sink.
  flush(/*IsEnd=*/true);
  if (!choose(C))
    return false;
  Held = C;
  tellOfFile();
  wake();
  return true;
}

Config Runtime::current() {
  std::lock_guard<std::mutex> Guard(Changing);
  return Held;
}

std::string Runtime::status() {
  std::lock_guard<std::mutex> Guard(Changing);
  std::string Text =
      std::string("sink=") + text(Held.Sink) + " policy=" + text(Filled.Policy);
  if (Filled.Policy != Policy::Every)
    Text +=
        " period=" + std::to_string(static_cast<double>(Filled.PeriodNs) / 1e9);
  if (Filled.SiteCap)
    Text += " site_cap=" + std::to_string(Filled.SiteCap);
  if (Filled.ProcessCap)
    Text += " process_cap=" + std::to_string(Filled.ProcessCap);
  Text += " sites=" + std::to_string(sites().size()) +
          " dropped=" + std::to_string(DroppedInAll.load());
  if (LogFile *F = NowFile.load(); F && Held.Sink == SinkKind::File)
    Text += std::string(" state=") + (F->isStopped() ? "stopped" : "open") +
            " file=" + F->path();
  if (LogFile *F = NowFile.load(); F && RingRuns) {
    auto [Files, Bytes] = Segments.size();
    char Minutes[32];
    snprintf(Minutes, sizeof(Minutes), "%g",
             static_cast<double>(Held.RingNs) / 60e9);
    Text += std::string(" ring=") + Minutes +
            " ring_files=" + std::to_string(Files + 1) + " ring_mib=" +
            std::to_string((Bytes + F->diskBytes() + (1 << 20) - 1) >> 20) +
            "/" + std::to_string(Held.RingBudgetMiB) +
            (F->isStopped() ? " ring_state=stopped" : " ring_state=open") +
            " ring_folder=" + F->path().substr(0, F->path().rfind('/'));
  }
  std::string More = NowSink.load()->status();
  return More.empty() ? Text : Text + " " + More;
}

//===----------------------------------------------------------------------===//
// The helper thread
//===----------------------------------------------------------------------===//

void Runtime::startHelper() {
  // Signals are for the program's own threads. They are not blocked here in
  // this thread, even for a moment: a signal that comes then goes to another
  // one, and if a handler that calls ros::shutdown() runs in roscpp's own
  // threads, the node aborts.
  pthread_attr_t Attributes;
  pthread_attr_init(&Attributes);
#ifdef TPC_HAS_ATTR_SIGMASK
  sigset_t All;
  sigfillset(&All);
  pthread_attr_setsigmask_np(&Attributes, &All);
#endif
  auto Body = [](void *) -> void * {
#ifndef TPC_HAS_ATTR_SIGMASK
    // Until here a signal may come to this thread, but only if no other one
    // takes it, and Linux asks the main thread first.
    sigset_t Every;
    sigfillset(&Every);
    pthread_sigmask(SIG_SETMASK, &Every, nullptr);
#endif
    of().help();
    return nullptr;
  };
  HelperRuns = !pthread_create(&Helper, &Attributes, Body, nullptr);
  if (HelperRuns)
    pthread_setname_np(Helper, "tpc");
  else
    warn("cannot start a thread: settings cannot be changed while the program "
         "runs, and summaries are written when it ends");
  pthread_attr_destroy(&Attributes);
}

void Runtime::wake() {
  if (!IsAwake.exchange(true))
    sem_post(&Wake);
}

void Runtime::help() {
  NextRos = NextPoll = NextPeriod = NextSecond = 0;
  Clock::adjust();
  int64_t Next = Clock::steady() + FirstAdjustNs;
  for (;;) {
    if (Next == Never) {
      sem_wait(&Wake);
    } else {
      // Steady time: setting the wall clock must not stop the periods.
      timespec Until{Next / Second, Next % Second};
      sem_clockwait(&Wake, CLOCK_MONOTONIC, &Until);
    }
    if (IsEnding)
      return;
    if (IsAwake.exchange(false))
      NextRos = 0;
    Next = runDue(Clock::steady());
  }
}

/// Does what is due at \p Now; returns when the next thing is due.
int64_t Runtime::runDue(int64_t Now) {
  // No lock is held, because roscpp calls back into apply().
  if (Now >= NextRos) {
    int64_t After = pollRos();
    NextRos = After < 0 ? Never : Now + After;
  }
  // A ROS that was loaded, or started, only now may turn out not to work.
  if (Config Now = current(); !(possible(Now) == Now) && !apply(Now)) {
    // As when the runtime starts: the warning has been given.
    Now.Sink = SinkKind::Off;
    apply(Now);
  }
  // ROS knows it only some time after its start, and a program may change it.
  TimeIsSimulated = rosTimeIsSimulated();
  std::lock_guard<std::mutex> Guard(Changing);
  turnRing(Now);
  LogFile *File = fileInUse();
  bool HasPeriods = isSummarised();
  if (File) {
    File->lookAhead();
    File->setNode(rosNodeName());
    int64_t Offset = Clock::real() - Clock::steady();
    if (Offset - RealOffset > Jump || RealOffset - Offset > Jump)
      NextSecond = Now;
    RealOffset = Offset;
  }
  if (HasPeriods && Now >= NextPeriod) {
    flush(/*IsEnd=*/false);
    int64_t Period = periodNs();
    NextPeriod += Period;
    if (NextPeriod <= Now)
      NextPeriod = Now + Period;
  }
  Sink &S = *NowSink.load();
  bool IsPolled = S.isPolled();
  if (IsPolled && Now >= NextPoll) {
    // Whoever reads a report should know by then whose it is.
    ReadNames::all().give(summarySink(), Now);
    S.poll();
    NextPoll = Now + PollNs;
  }
  bool HasSeconds = File || RingRuns || HasPeriods || SiteCap || ProcessCap ||
                    (Held.Sink != SinkKind::Off && ReadNames::all().any());
  if (HasSeconds && Now >= NextSecond) {
    eachSecond();
    NextSecond = Now + Second;
  }
  int64_t Next = NextRos;
  if (HasPeriods)
    Next = std::min(Next, NextPeriod);
  if (IsPolled)
    Next = std::min(Next, NextPoll);
  if (HasSeconds)
    Next = std::min(Next, NextSecond);
  if (RingRuns)
    Next =
        std::min(Next, NextSegment > Now ? NextSegment : Segments.dueAt(Held));
  return Next;
}

/// Whether the policy keeps evaluations for a period.
bool Runtime::isSummarised() const {
  return Held.Sink != SinkKind::Off && Filled.Policy != Policy::Every;
}

void Runtime::flush(bool IsEnd) {
  if (!isSummarised())
    return;
  Sink &S = summarySink();
  if (Filled.Policy == Policy::Edges)
    return flushEdges(S, /*All=*/IsEnd);
  SummaryLimit Limit;
  if (Held.Sink != SinkKind::File) {
    Limit.Most =
        std::max<uint64_t>(SummariesOfSecond * Filled.PeriodNs / Second, 1);
    Limit.OldestNs = periodNs() * PeriodsOfQuiet;
  }
  flushLight(S, IsEnd, Limit);
}

/// The default period and the default caps of `light` are those of the robot's
/// clock: a recording of a simulated robot that is faster than real time has as
/// much of each second as one of a real robot.
int64_t Runtime::periodNs() const {
  const auto Period = static_cast<int64_t>(Filled.PeriodNs);
  return Held.PeriodNs == Config::Usual && Filled.Policy == Policy::Light
             ? std::max<int64_t>(Period / 1000 * (ClockSecond / 1'000'000), 1)
             : Period;
}

void Runtime::setCaps(const Config &C) {
  auto Scaled = [&](uint64_t Set, uint64_t Cap) {
    return Set == Config::Usual && Filled.Policy == Policy::Light
               ? Cap * Second / static_cast<uint64_t>(ClockSecond)
               : Cap;
  };
  SiteCap = Scaled(C.SiteCap, Filled.SiteCap);
  ProcessCap = Scaled(C.ProcessCap, Filled.ProcessCap);
}

/// Measures how fast the simulated time is.
void Runtime::followClock() {
  const int64_t Steady = Clock::steady();
  const int64_t Ros = TimeIsSimulated ? rosNow() : 0;
  int64_t Now = Second;
  if (LastRos > 0 && Ros > LastRos && Steady > LastSteady)
    Now = std::clamp(
        static_cast<int64_t>(static_cast<double>(Second) *
                             static_cast<double>(Steady - LastSteady) /
                             static_cast<double>(Ros - LastRos)),
        Second / FastestClock, Second);
  LastSteady = Steady;
  LastRos = Ros;
  if (Now == ClockSecond)
    return;
  ClockSecond = Now;
  setCaps(Held);
}

void Runtime::eachSecond() {
  Clock::adjust();
  followClock();
  giveLate();
  if (LogFile *F = fileInUse())
    F->sync();
  accountForDrops();
  ReadNames::all().give(summarySink(), Clock::steady());
}

/// Threads may have been inside the sink that was left.
void Runtime::giveLate() {
  if (LogFile *F = NowFile.load(); F && Left)
    Left->giveTo(*F);
}

void Runtime::accountForDrops() {
  Sink &S = summarySink();
  auto Account = [&](const char *Key, uint32_t Number, DropCount &D,
                     DropReason Why) {
    uint64_t Count = D.Count.exchange(0), Flops = D.Flops.exchange(0);
    if (!Count)
      return;
    DroppedInAll += Count;
    S.take(Dropped{Key, Number, Count, Flops, Why});
    // Nobody has asked a program without ROS for reports.
    bool IsAsked = Held.Sink != SinkKind::Auto || *rosNodeName();
    if (Filled.Policy == Policy::Light && *Key && IsAsked &&
        !std::exchange(HasToldOfCaps, true))
      warn(std::string("comparison ") + Key + " changes more often than " +
           (Why == DropReason::SiteCap ? std::to_string(Filled.SiteCap) +
                                             " times a second (TPC_SITE_CAP)"
                                       : "TPC_PROCESS_CAP allows") +
           ": further changes are only counted, here and elsewhere");
  };
  for (uint32_t Number = 1; Number <= sites().size(); ++Number) {
    Site &At = sites()[Number];
    Account(At.Key.c_str(), Number, At.OverSiteCap, DropReason::SiteCap);
    Account(At.Key.c_str(), Number, At.OverProcessCap, DropReason::ProcessCap);
  }
  for (Thread *T : allThreads())
    if (uint64_t Count = T->Nested.exchange(0)) {
      DroppedInAll += Count;
      S.take(Dropped{"", 0, Count, 0, DropReason::Nested});
    }
}

void Runtime::end() {
  if (IsEnding.exchange(true))
    return;
  sem_post(&Wake);
  if (ThisThread && (ThisThread->Inside.load() & 1)) {
    // A signal handler has interrupted a report of this thread to end the
    // process. The report may hold any lock. The file is complete without its
    // end.
    rosEnd(/*IsInterrupted=*/true);
    return;
  }
  if (HelperRuns) {
    // It may be waiting for a ROS master that no longer answers.
    timespec Until;
    clock_gettime(CLOCK_REALTIME, &Until);
    Until.tv_sec += 2;
    if (pthread_timedjoin_np(Helper, nullptr, &Until)) {
      // The file needs no helper.
      if (LogFile *F = NowFile.load())
        F->close();
      return;
    }
  }
  std::lock_guard<std::mutex> Guard(Changing);
  if (!IsStarted)
    return;
  Sink &S = *NowSink.load();
  flush(/*IsEnd=*/true);
  if (Held.Sink != SinkKind::Off) {
    accountForDrops();
    ReadNames::all().give(summarySink(), Clock::steady());
  }
  giveLate();
  S.end();
  rosEnd(/*IsInterrupted=*/false);
  if (LogFile *F = NowFile.load())
    F->close();
  Segments.end();
}

//===----------------------------------------------------------------------===//
// fork
//===----------------------------------------------------------------------===//

void Runtime::beforeFork() {
  Starting.lock();
  Changing.lock();
  sites().lock();
  ReadNames::all().lock();
  lockThreads();
  lockStores();
}

void Runtime::afterFork(bool IsChild) {
  unlockStores(IsChild);
  unlockThreads();
  ReadNames::all().unlock();
  sites().unlock();
  Changing.unlock();
  Starting.unlock();
  if (!IsChild)
    return;
  // Only this thread is left. The file belongs to the parent; the first report
  // creates a new one, and a new helper.
  sem_init(&Wake, 0, 0);
  threadsAfterFork();
  ReadNames::all().startAgain();
  sites().afterFork();
  lightAfterFork();
  for (uint32_t Number = 1; Number <= sites().size(); ++Number)
    sites()[Number].Last = -1;
  NowFile = nullptr;
  SlotsHome = nullptr;
  Segments.forget();
  for (uint32_t Number = 1; Number <= sites().size(); ++Number)
    sites()[Number].StatedIn = nullptr;
  IsStarted = HelperRuns = false;
  IsAwake = false;
  NowMode = Mode::NotStarted;
  tpc_reporting = 1;
}

} // namespace

//===----------------------------------------------------------------------===//
// Entry points
//===----------------------------------------------------------------------===//

Sink &summarySink() {
  // Never destroyed: threads report until the process ends.
  static auto &Beside = *new BesideSink;
  return RingRuns && !ReportsToFile ? Beside : *NowSink.load();
}

Config current() { return Runtime::of().current(); }
bool apply(const Config &C) { return Runtime::of().apply(C); }
std::string statusLine() { return Runtime::of().status(); }
void wakeHelper() { Runtime::of().wake(); }
void startRuntime() { Runtime::of().start(); }
void endRuntime() { Runtime::of().end(); }

void warn(const std::string &Text) {
  // A single write, so that lines of several processes do not mix.
  std::string Line = "tpc: " + Text + "\n";
  if (::write(STDERR_FILENO, Line.data(), Line.size()) < 0)
    return;
}

} // namespace tpc
