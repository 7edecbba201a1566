//===- Runtime.cpp - The chosen settings, and the helper thread -----------===//
#include "Runtime.h"

#include "Edges.h"
#include "Modes.h"
#include "ros1/RosControl.h"

#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

namespace tpc {

static constexpr int64_t Second = 1'000'000'000;
static constexpr int64_t PollNs = 20'000'000;
static constexpr int64_t Never = INT64_MAX;
/// Until then the rate of the counter is not known well enough to use it.
static constexpr int64_t FirstAdjustNs = 10'000'000;
static constexpr int64_t Jump = 1'000'000;

//===----------------------------------------------------------------------===//
// The state that log_one reads
//===----------------------------------------------------------------------===//

std::atomic<Mode> NowMode{Mode::NotStarted};
std::atomic<LogFile *> NowFile{nullptr};
std::atomic<Sink *> NowSink{nullptr};
std::atomic<bool> ReportsToFile{false};
Sites *TheSites = nullptr;
std::atomic<uint64_t> SiteCap{0}, ProcessCap{0};
Meter ProcessMeter;

namespace {

/// Represents the file among the sinks.
class FileSink final : public Sink {
public:
  void take(const Report &) override {} // log_one writes these itself
  void take(const Summary &S) override {
    if (LogFile *F = NowFile.load())
      F->write(S);
  }
  void take(const Dropped &D) override {
    if (LogFile *F = NowFile.load())
      F->write(D);
  }
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
  bool apply(const Config &C);
  Config current();
  std::string status();
  void wake();
  void end();

  void beforeFork();
  void afterFork(bool IsChild);

private:
  Runtime();

  static Sink &sinkOf(SinkKind K);
  bool choose(const Config &C);
  bool needsFile(const Config &C);
  void startHelper();
  void help();
  int64_t runDue(int64_t Now);
  void eachSecond();
  void accountForDrops();

  std::mutex Changing; ///< for everything that follows
  Config Held;
  bool IsStarted = false;
  bool HasSettings = false; ///< Held was read or set, perhaps before a fork
  bool HelperRuns = false;
  pthread_t Helper{};

  std::mutex Waiting; ///< for the next three
  std::condition_variable Wake;
  bool IsAwake = false;
  bool IsEnding = false;

  // Used by the helper only.
  int64_t NextRos = 0, NextPoll = 0, NextPeriod = 0, NextSecond = 0;
  int64_t RealOffset = 0;
  std::atomic<uint64_t> DroppedInAll{0};
};

Runtime::Runtime() {
  // Never destroyed, like this object: threads report until the process ends.
  TheSites = new Sites;
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
  std::lock_guard<std::mutex> Guard(Changing);
  if (IsStarted)
    return;
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
  if (!choose(Held)) {
    // The warning has been given; a ROS parameter may name another folder.
    Held.Sink = SinkKind::Off;
    choose(Held);
  }
  // Only now: if memory ran out, the next report tries again.
  IsStarted = true;
  startHelper();
}

bool Runtime::needsFile(const Config &C) {
  LogFile *F = NowFile.load();
  return !F || F->isStopped() || C.Folder != Held.Folder ||
         C.FileLimitMiB != Held.FileLimitMiB;
}

/// Makes log_one follow \p C; false if its file cannot be created.
bool Runtime::choose(const Config &C) {
  if (C.Sink == SinkKind::File) {
    if (needsFile(C)) {
      std::string Why;
      LogFile *File = LogFile::open(C, Why);
      if (!File) {
        warn(Why + "; no reports are written to a file");
        return false;
      }
      if (LogFile *Old = NowFile.exchange(File))
        Old->close();
    }
    NowFile.load()->writePolicy(C);
  }
  SiteCap = C.SiteCap;
  ProcessCap = C.ProcessCap;
  ReportsToFile = C.Sink == SinkKind::File;
  SlotsHome = ReportsToFile ? NowFile.load() : nullptr;
  Sink *Old = NowSink.exchange(&sinkOf(C.Sink));
  bool IsCapped = C.SiteCap || C.ProcessCap;
  NowMode = C.Sink == SinkKind::Off     ? Mode::Off
            : C.Policy == Policy::Edges ? Mode::Edges
            : C.Sink == SinkKind::File
                ? (IsCapped ? Mode::Capped : Mode::FileEvery)
            : IsCapped ? Mode::Capped
                       : Mode::SinkEvery;
  tpc_reporting = C.Sink == SinkKind::Off ? 0 : 1;
  if (Old && Old != NowSink.load())
    Old->end();
  return true;
}

bool Runtime::apply(const Config &C) {
  start();
  std::lock_guard<std::mutex> Guard(Changing);
  if (C == Held)
    return true;
  // What `edges` has kept so far goes to the old sink.
  if (Held.Policy == Policy::Edges && Held.Sink != SinkKind::Off)
    flushEdges(*NowSink.load(), /*All=*/true);
  if (!choose(C))
    return false;
  Held = C;
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
      std::string("sink=") + text(Held.Sink) + " policy=" + text(Held.Policy);
  if (Held.Policy == Policy::Edges)
    Text +=
        " period=" + std::to_string(static_cast<double>(Held.PeriodNs) / 1e9);
  if (Held.SiteCap)
    Text += " site_cap=" + std::to_string(Held.SiteCap);
  if (Held.ProcessCap)
    Text += " process_cap=" + std::to_string(Held.ProcessCap);
  Text += " sites=" + std::to_string(sites().size()) +
          " dropped=" + std::to_string(DroppedInAll.load());
  if (LogFile *F = NowFile.load(); F && Held.Sink == SinkKind::File)
    Text += std::string(" state=") + (F->isStopped() ? "stopped" : "open") +
            " file=" + F->path();
  std::string More = NowSink.load()->status();
  return More.empty() ? Text : Text + " " + More;
}

//===----------------------------------------------------------------------===//
// The helper thread
//===----------------------------------------------------------------------===//

void Runtime::startHelper() {
  // Signals are for the program's own threads.
  sigset_t All, Old;
  sigfillset(&All);
  pthread_sigmask(SIG_SETMASK, &All, &Old);
  auto Body = [](void *) -> void * {
    of().help();
    return nullptr;
  };
  HelperRuns = !pthread_create(&Helper, nullptr, Body, nullptr);
  if (HelperRuns)
    pthread_setname_np(Helper, "tpc");
  else
    warn("cannot start a thread: settings cannot be changed while the program "
         "runs, and summaries are written when it ends");
  pthread_sigmask(SIG_SETMASK, &Old, nullptr);
}

void Runtime::wake() {
  {
    std::lock_guard<std::mutex> Guard(Waiting);
    IsAwake = true;
  }
  Wake.notify_one();
}

void Runtime::help() {
  NextRos = NextPoll = NextPeriod = NextSecond = 0;
  Clock::adjust();
  int64_t Next = Clock::steady() + FirstAdjustNs;
  for (;;) {
    {
      std::unique_lock<std::mutex> Guard(Waiting);
      auto Done = [this] { return IsAwake || IsEnding; };
      if (Next == Never)
        Wake.wait(Guard, Done);
      else
        // Steady time: setting the wall clock must not stop the periods.
        Wake.wait_until(Guard,
                        std::chrono::steady_clock::time_point(
                            std::chrono::nanoseconds(Next)),
                        Done);
      if (IsEnding)
        return;
      if (IsAwake)
        NextRos = 0;
      IsAwake = false;
    }
    Next = runDue(Clock::steady());
  }
}

/// Does what is due at \p Now; returns when the next thing is due.
int64_t Runtime::runDue(int64_t Now) {
  // No lock is held, because roscpp calls back into apply().
  if (Now >= NextRos) {
    int64_t After = forkedFromNode() ? -1 : pollRos();
    NextRos = After < 0 ? Never : Now + After;
  }
  // roscpp knows it only some time after its start, and a program may change
  // it.
  TimeIsSimulated = rosTimeIsSimulated();
  std::lock_guard<std::mutex> Guard(Changing);
  LogFile *File = Held.Sink == SinkKind::File ? NowFile.load() : nullptr;
  bool IsEdges = Held.Policy == Policy::Edges && Held.Sink != SinkKind::Off;
  if (File) {
    File->lookAhead();
    File->setNode(rosNodeName());
    int64_t Offset = Clock::real() - Clock::steady();
    if (Offset - RealOffset > Jump || RealOffset - Offset > Jump)
      NextSecond = Now;
    RealOffset = Offset;
  }
  if (IsEdges && Now >= NextPeriod) {
    flushEdges(*NowSink.load(), /*All=*/false);
    NextPeriod += Held.PeriodNs;
    if (NextPeriod <= Now)
      NextPeriod = Now + Held.PeriodNs;
  }
  Sink &S = *NowSink.load();
  bool IsPolled = S.isPolled();
  if (IsPolled && Now >= NextPoll) {
    S.poll();
    NextPoll = Now + PollNs;
  }
  bool HasSeconds = File || IsEdges || SiteCap || ProcessCap;
  if (HasSeconds && Now >= NextSecond) {
    eachSecond();
    NextSecond = Now + Second;
  }
  int64_t Next = NextRos;
  if (IsEdges)
    Next = std::min(Next, NextPeriod);
  if (IsPolled)
    Next = std::min(Next, NextPoll);
  if (HasSeconds)
    Next = std::min(Next, NextSecond);
  return Next;
}

void Runtime::eachSecond() {
  Clock::adjust();
  if (Held.Sink == SinkKind::File)
    NowFile.load()->sync();
  accountForDrops();
}

void Runtime::accountForDrops() {
  Sink &S = *NowSink.load();
  auto Account = [&](const char *Key, uint32_t Number, DropCount &D,
                     DropReason Why) {
    uint64_t Count = D.Count.exchange(0), Flops = D.Flops.exchange(0);
    if (!Count)
      return;
    DroppedInAll += Count;
    S.take(Dropped{Key, Number, Count, Flops, Why});
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
  {
    std::lock_guard<std::mutex> Guard(Waiting);
    if (IsEnding)
      return;
    IsEnding = true;
  }
  Wake.notify_one();
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
  if (Held.Policy == Policy::Edges && Held.Sink != SinkKind::Off)
    flushEdges(S, /*All=*/true);
  if (Held.Sink != SinkKind::Off)
    accountForDrops();
  S.end();
  rosEnd();
  if (LogFile *F = NowFile.load())
    F->close();
}

//===----------------------------------------------------------------------===//
// fork
//===----------------------------------------------------------------------===//

void Runtime::beforeFork() {
  Changing.lock();
  Waiting.lock();
  sites().lock();
  lockThreads();
}

void Runtime::afterFork(bool IsChild) {
  unlockThreads();
  sites().unlock();
  Waiting.unlock();
  Changing.unlock();
  if (!IsChild)
    return;
  // Only this thread is left. The file belongs to the parent; the first report
  // creates a new one, and a new helper.
  new (&Wake) std::condition_variable;
  threadsAfterFork();
  sites().afterFork();
  for (uint32_t Number = 1; Number <= sites().size(); ++Number)
    sites()[Number].Last = -1;
  NowFile = nullptr;
  SlotsHome = nullptr;
  IsStarted = HelperRuns = false;
  IsAwake = false;
  NowMode = Mode::NotStarted;
  tpc_reporting = 1;
}

} // namespace

//===----------------------------------------------------------------------===//
// Entry points
//===----------------------------------------------------------------------===//

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
