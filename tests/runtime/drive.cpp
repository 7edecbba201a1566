//===- drive.cpp - Programs that report, for the tests of the log library -===//
//
// drive WHAT ARGUMENT...; each function below is one WHAT. What a test compares
// with comes from here, counted beside the library and not by it.
//
//===----------------------------------------------------------------------===//
#include "LogOne.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <functional>
#include <map>
#include <pthread.h>
#include <signal.h>
#include <string>
#include <sys/mman.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

extern char tpc_reporting;
/// What an instrumented module has for a comparison (SiteWords.h).
struct alignas(64) WordsOfModule {
  std::atomic<int32_t> Left[2];
  std::atomic<const void *> Object;
  char Key[48];
};
extern "C" void tpc_register_sites(WordsOfModule *First, uint64_t Count);
extern "C" void tpc_forget_sites(WordsOfModule *First);

namespace {

using Arguments = std::vector<std::string>;

/// The key of the site with this number, from 0.
std::string keyOf(unsigned long Number) {
  char Text[48];
  std::snprintf(Text, sizeof(Text), "%08lx-0000-5000-8000-000000000000",
                Number);
  return Text;
}

/// Keys whose addresses stay.
class Keys {
public:
  explicit Keys(unsigned long Count) {
    for (unsigned long I = 0; I < Count; ++I)
      Texts.push_back(keyOf(I));
  }
  char *operator[](unsigned long I) { return Texts[I % Texts.size()].data(); }

private:
  std::vector<std::string> Texts;
};

void waitMs(long Ms) {
  std::this_thread::sleep_for(std::chrono::milliseconds(Ms));
}

/// Report I of a thread: compared is I, the threshold the thread's number, and
/// every 7th time the result changes.
void report(char *Key, uint64_t I, unsigned Thread) {
  bool Result = I / 7 % 2;
  log_one(Key, Result, static_cast<double>(I), Thread, !Result);
}

/// threads THREADS SITES REPORTS: so many reports in each thread.
int threads(const Arguments &A) {
  unsigned Threads = std::stoul(A[0]);
  uint64_t Reports = std::stoull(A[2]);
  Keys K(std::stoul(A[1]));
  std::vector<std::thread> All;
  for (unsigned T = 0; T < Threads; ++T)
    All.emplace_back([&, T] {
      for (uint64_t I = 0; I < Reports; ++I)
        report(K[I], I, T);
    });
  for (std::thread &T : All)
    T.join();
  return 0;
}

/// counted FILE THREADS SITES PAUSE_US: reports until it is killed; FILE has a
/// uint64 for each thread, the reports that are done.
int counted(const Arguments &A) {
  unsigned Threads = std::stoul(A[1]);
  Keys K(std::stoul(A[2]));
  long Pause = std::stol(A[3]);
  int File = open(A[0].c_str(), O_RDWR | O_CREAT, 0666);
  if (File < 0 || ftruncate(File, 4096))
    return 1;
  auto *Done = static_cast<std::atomic<uint64_t> *>(
      mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, File, 0));
  for (unsigned T = 0; T < Threads; ++T)
    std::thread([&, T] {
      for (uint64_t I = 0;; ++I) {
        report(K[I], I, T);
        Done[T].store(I + 1, std::memory_order_release);
        if (Pause)
          std::this_thread::sleep_for(std::chrono::microseconds(Pause));
      }
    }).detach();
  std::puts("ready");
  std::fflush(stdout);
  for (;;)
    pause();
}

struct Stays {
  std::atomic<uint64_t> Times, MayGoOn;
} *StaysOfStuck;

/// stuck FILE: the main thread reports one key and another one 19 others, until
/// the program is killed. At SIGUSR1 the main thread stays where it is, which
/// is inside a report unless a cap takes no time
/// often it stayed, and how often it may go on.
int stuck(const Arguments &A) {
  static Keys K(20);
  int File = open(A[0].c_str(), O_RDWR | O_CREAT, 0666);
  if (File < 0 || ftruncate(File, sizeof(Stays)))
    return 1;
  StaysOfStuck = static_cast<Stays *>(mmap(
      nullptr, sizeof(Stays), PROT_READ | PROT_WRITE, MAP_SHARED, File, 0));
  sigset_t Its;
  sigemptyset(&Its);
  sigaddset(&Its, SIGUSR1);
  pthread_sigmask(SIG_BLOCK, &Its, nullptr);
  std::thread([] {
    for (uint64_t I = 0;; ++I) {
      report(K[1 + I % 19], I, 1);
      if (I % 10 == 0)
        std::this_thread::sleep_for(std::chrono::microseconds(1));
    }
  }).detach();
  pthread_sigmask(SIG_UNBLOCK, &Its, nullptr);
  struct sigaction Action{};
  Action.sa_handler = [](int) {
    uint64_t Time = ++StaysOfStuck->Times;
    while (StaysOfStuck->MayGoOn < Time)
      usleep(1000);
  };
  sigaction(SIGUSR1, &Action, nullptr);
  std::puts("ready");
  std::fflush(stdout);
  for (uint64_t I = 0;; ++I)
    report(K[0], I, 0);
}

/// Whether the folder of reports has a file whose name ends with \p End.
bool hasFile(const std::string &End) {
  std::error_code None;
  for (auto &One :
       std::filesystem::directory_iterator(std::getenv("TPC_FOLDER"), None)) {
    std::string Name = One.path().filename();
    if (Name.size() > End.size() &&
        !Name.compare(Name.size() - End.size(), End.size(), End))
      return true;
  }
  return false;
}

/// seldom COUNT [END]: key 1 is true once; key 0 is true every millisecond
/// until there is a file whose name ends with END, and then COUNT times, and
/// their number is printed; then key 1 is false.
int seldom(const Arguments &A) {
  Keys K(2);
  long More = std::stol(A[0]), Count = 0;
  bool Waits = A.size() > 1;
  log_one(K[1], true, 3, 2, true);
  for (; Waits || More; ++Count) {
    log_one(K[0], true, 5, 1, true);
    waitMs(1);
    if (!Waits)
      --More;
    else if (Count % 50 == 0)
      Waits = !hasFile(A[1]);
  }
  log_one(K[1], false, 1, 2, false);
  std::printf("%ld\n", Count);
  return 0;
}

/// forked REPORTS: in the parent, in a child, in the child's child, and again
/// in the parent, while another of its threads reports, too.
int forked(const Arguments &A) {
  uint64_t Reports = std::stoull(A[0]);
  Keys K(3);
  auto All = [&](unsigned Who) {
    for (uint64_t I = 0; I < Reports; ++I)
      report(K[I], I, Who);
  };
  std::atomic<bool> Stop{false};
  // Slower when it has done enough: a child that waits for a processor must not
  // cost a file that fits no memory.
  std::thread Other([&] {
    for (uint64_t I = 0; !Stop; ++I) {
      report(K[I], I, 100);
      if (I > 500'000)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  All(1);
  pid_t Child = fork();
  if (!Child) {
    All(2);
    pid_t Grandchild = fork();
    if (!Grandchild) {
      All(3);
      std::exit(0);
    }
    int Status = 1;
    waitpid(Grandchild, &Status, 0);
    std::exit(Status ? 1 : 0);
  }
  All(1);
  int Status = 1;
  waitpid(Child, &Status, 0);
  Stop = true;
  Other.join();
  return Status ? 1 : 0;
}

char EarlyKey[] = "eeeeeeee-0000-5000-8000-000000000000";
char LateKey[] = "ffffffff-0000-5000-8000-000000000000";

/// Reports before main and after it.
struct EarlyAndLate {
  EarlyAndLate() {
    if (std::getenv("DRIVE_EARLY"))
      log_one(EarlyKey, true, 1, 0, true);
  }
  ~EarlyAndLate() {
    if (std::getenv("DRIVE_EARLY"))
      log_one(LateKey, true, 2, 0, true);
  }
} Global;

struct AtThreadEnd {
  char Key[37] = "dddddddd-0000-5000-8000-000000000000";
  ~AtThreadEnd() { log_one(Key, true, 3, 0, true); }
};

/// ends: at the end of threads, and by a thread that outlives main.
int ends(const Arguments &) {
  for (int I = 0; I < 50; ++I)
    std::thread([] {
      thread_local AtThreadEnd End;
      log_one(End.Key, false, 4, 0, false);
    }).join();
  static auto *K = new Keys(1); // outlives main
  std::thread([] {
    for (uint64_t I = 0;; ++I) {
      report((*K)[0], I, 9);
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    }
  }).detach();
  waitMs(5);
  return 0;
}

Keys *SignalKeys;
std::atomic<uint64_t> InHandler{0};

/// signals MS: a handler reports while the program does. Prints both numbers.
int signals(const Arguments &A) {
  SignalKeys = new Keys(2);
  (*SignalKeys)[0];
  struct sigaction Action{};
  Action.sa_handler = [](int) {
    log_one((*SignalKeys)[1], true, static_cast<double>(InHandler++), 0, true);
  };
  Action.sa_flags = SA_RESTART;
  log_one((*SignalKeys)[1], true, -1, 0, true);
  sigaction(SIGPROF, &Action, nullptr);
  itimerval Often{{0, 100}, {0, 100}};
  setitimer(ITIMER_PROF, &Often, nullptr);
  auto Until = std::chrono::steady_clock::now() +
               std::chrono::milliseconds(std::stol(A[0]));
  uint64_t I = 0;
  // The timer counts processor time, of which a busy machine gives little.
  while (std::chrono::steady_clock::now() < Until || InHandler == 0)
    for (int More = 0; More < 100; ++More)
      report((*SignalKeys)[0], I++, 0);
  itimerval Never{};
  setitimer(ITIMER_PROF, &Never, nullptr);
  waitMs(20);
  std::printf("%llu %llu\n", static_cast<unsigned long long>(I),
              static_cast<unsigned long long>(InHandler.load()));
  return 0;
}

/// exits: a handler ends the process while the program reports.
int exits(const Arguments &) {
  Keys K(100);
  struct sigaction Action{};
  Action.sa_handler = [](int) { std::exit(0); };
  sigaction(SIGPROF, &Action, nullptr);
  itimerval Soon{{0, 0}, {0, 20'000}};
  setitimer(ITIMER_PROF, &Soon, nullptr);
  for (uint64_t I = 0;; ++I)
    report(K[I], I, 0);
}

/// together THREADS SITES: so many threads begin at once, and each evaluates
/// each site once. Prints how long this took the slowest one, in milliseconds.
int together(const Arguments &A) {
  using Clock = std::chrono::steady_clock;
  Keys K(std::stoul(A[1]));
  std::atomic<bool> Begun{false};
  std::vector<std::thread> All;
  std::vector<double> Took(std::stoul(A[0]));
  for (double &Ms : Took)
    All.emplace_back([&] {
      while (!Begun)
        std::this_thread::yield();
      const auto Start = Clock::now();
      for (unsigned long I = 0; I < std::stoul(A[1]); ++I)
        report(K[I], 0, 0);
      Ms = std::chrono::duration<double, std::milli>(Clock::now() - Start)
               .count();
    });
  Begun = true;
  for (std::thread &T : All)
    T.join();
  std::printf("%.3f\n", *std::max_element(Took.begin(), Took.end()));
  return 0;
}

/// cancelled THREADS: each reports until it is cancelled.
int cancelled(const Arguments &A) {
  static auto *K = new Keys(1);
  for (unsigned long T = std::stoul(A[0]); T; --T) {
    pthread_t Thread;
    auto Body = [](void *) -> void * {
      for (uint64_t I = 0;; ++I) {
        report((*K)[0], I, 0);
        if (I % 64 == 0)
          pthread_testcancel();
      }
    };
    if (pthread_create(&Thread, nullptr, Body, nullptr))
      return 1;
    waitMs(2);
    pthread_cancel(Thread);
    pthread_join(Thread, nullptr);
  }
  return 0;
}

/// closed FILE REPORTS: closes all descriptors after the first report, as
/// daemons do, writes FILE and reports on.
int closed(const Arguments &A) {
  Keys K(1);
  report(K[0], 0, 0);
  for (int Descriptor = 3; Descriptor < 64; ++Descriptor)
    close(Descriptor);
  // The lowest one that is free, which was the log's.
  int File = open(A[0].c_str(), O_RDWR | O_CREAT | O_TRUNC, 0666);
  if (write(File, "mine", 4) != 4)
    return 1;
  for (uint64_t I = 1; I < std::stoull(A[1]); ++I)
    report(K[0], I, 0);
  return 0;
}

/// paced PER_SECOND MS SITES: reports at that rate from one thread.
int paced(const Arguments &A) {
  double Rate = std::stod(A[0]);
  auto Begin = std::chrono::steady_clock::now();
  auto End = Begin + std::chrono::milliseconds(std::stol(A[1]));
  Keys K(std::stoul(A[2]));
  for (uint64_t I = 0; std::chrono::steady_clock::now() < End; ++I) {
    report(K[I], I, 0);
    std::this_thread::sleep_until(
        Begin + std::chrono::nanoseconds(static_cast<int64_t>(
                    1e9 * static_cast<double>(I + 1) / Rate)));
  }
  return 0;
}

/// edges THREADS SITES REPORTS PAUSE_MS: every thread reports at all sites in
/// turn, one thread after the other has its share of each site's results; then
/// waits. What each site should have in all: `KEY COUNT FLOPS LOW HIGH SUM`,
/// printed for one thread alone (threads mix flops).
int edges(const Arguments &A) {
  unsigned Threads = std::stoul(A[0]);
  unsigned long Sites = std::stoul(A[1]);
  uint64_t Reports = std::stoull(A[2]);
  Keys K(Sites);
  std::vector<std::thread> All;
  for (unsigned T = 0; T < Threads; ++T)
    All.emplace_back([&] {
      for (uint64_t I = 0; I < Reports; ++I) {
        uint64_t Turn = I / Sites;
        double Value = static_cast<double>(Turn % 1000) / 8;
        log_one(K[I], Value > 100, Value, 100, Value > 100);
        if (I % 1000 == 999)
          std::this_thread::sleep_for(std::chrono::microseconds(500));
      }
    });
  for (std::thread &T : All)
    T.join();
  waitMs(std::stol(A[3]));
  return 0;
}

/// hot REPORTS EVERY SITES_MS: one site, as fast as it goes; the outcome
/// changes after each EVERY reports (0: never); then waits.
int hot(const Arguments &A) {
  uint64_t Reports = std::stoull(A[0]), Every = std::stoull(A[1]);
  Keys K(1);
  for (uint64_t I = 0; I < Reports; ++I) {
    bool Result = Every && I / Every % 2;
    log_one(K[0], Result, Result ? 3 : 1, 2, Result);
  }
  waitMs(std::stol(A[2]));
  return 0;
}

/// odd: values that are no usual numbers, at one site.
int odd(const Arguments &) {
  Keys K(1);
  const double Values[] = {1, NAN, INFINITY, -INFINITY, 2, 1e308, 3};
  for (double V : Values)
    log_one(K[0], V > 1, V, V == 1e308 ? -1e308 : 1, V > 1);
  return 0;
}

/// objects OBJECTS TURNS: objects that evaluate one key in turns, all but the
/// second with the same outcome each time; the second changes it in each 10th
/// turn. Afterwards code without an object reports the key once more.
int objects(const Arguments &A) {
  std::vector<uint64_t> Objects(std::stoul(A[0]));
  uint64_t Turns = std::stoull(A[1]);
  Keys K(1);
  for (uint64_t Turn = 0; Turn < Turns; ++Turn)
    for (size_t I = 0; I < Objects.size(); ++I) {
      bool Result = I == 1 ? Turn / 10 % 2 : I % 2;
      log_one_of(K[0], Result, static_cast<double>(I), 0.5, Result,
                 &Objects[I]);
    }
  log_one(K[0], false, -1, 0.5, false);
  return 0;
}

/// objects-threads TURNS: two threads, each with an object of its own.
int objectsOfThreads(const Arguments &A) {
  uint64_t Turns = std::stoull(A[0]);
  uint64_t Objects[2];
  Keys K(1);
  std::vector<std::thread> All;
  for (size_t I = 0; I < 2; ++I)
    All.emplace_back([&, I] {
      for (uint64_t Turn = 0; Turn < Turns; ++Turn)
        log_one_of(K[0], I, static_cast<double>(I), 0.5, I, &Objects[I]);
    });
  for (std::thread &T : All)
    T.join();
  return 0;
}

/// names: keys that are none, as a hand-written call may have.
int names(const Arguments &) {
  std::string Long(10000, 'k');
  char Short[] = "x", Empty[] = "";
  for (char *Key : {Short, Empty, Long.data(), Short})
    log_one(Key, true, 1, 2, false);
  // The same address with another key.
  char Reused[40];
  for (int I = 0; I < 3; ++I) {
    std::strcpy(Reused, keyOf(500 + I).c_str());
    log_one(Reused, true, I, 2, false);
  }
  return 0;
}

WordsOfModule InPlace;
uint64_t Called;

/// What an instrumented module does instead of a call.
void evaluateInPlace(bool Result, const void *Object) {
  if (tpc_reporting == 2 && InPlace.Object == Object) {
    int32_t Left = InPlace.Left[Result];
    if (Left) {
      InPlace.Left[Result] = Left - (Left > 0);
      return;
    }
  }
  ++Called;
  log_one_of(InPlace.Key, Result, Result, 0.5, Result, Object);
}

/// in-place TURNS: a first object evaluates once in a while, a second one in a
/// hot loop. Prints how many evaluations were calls after the first fifth.
int inPlace(const Arguments &A) {
  uint64_t Turns = std::stoull(A[0]);
  std::strcpy(InPlace.Key, keyOf(0).c_str());
  tpc_register_sites(&InPlace, 1);
  int First, Second;
  for (uint64_t Turn = 0; Turn < Turns; ++Turn) {
    if (Turn == Turns / 5)
      Called = 0;
    if (Turn % 1000 == 0)
      evaluateInPlace(false, &First);
    evaluateInPlace(true, &Second);
    if (Turn % (Turns / 50) == 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::printf("%llu\n", static_cast<unsigned long long>(Called));
  tpc_forget_sites(&InPlace);
  // After that the words are not read any more.
  std::memset(static_cast<void *>(&InPlace), 0xff, sizeof(InPlace));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  return 0;
}

/// turning SITES TURNS MS: in each turn the outcomes of all sites change, in
/// the same order, and then the program waits.
int turning(const Arguments &A) {
  unsigned long Sites = std::stoul(A[0]), Turns = std::stoul(A[1]);
  Keys K(Sites);
  for (unsigned long Turn = 0; Turn < Turns; ++Turn) {
    for (unsigned long I = 0; I < Sites; ++I)
      log_one(K[I], Turn % 2, static_cast<double>(Turn), 0.5, Turn % 2);
    waitMs(std::stol(A[2]));
  }
  return 0;
}

} // namespace

int main(int Count, char **Words) {
  const std::map<std::string, std::function<int(const Arguments &)>> Known = {
      {"threads", threads},
      {"counted", counted},
      {"stuck", stuck},
      {"forked", forked},
      {"seldom", seldom},
      {"ends", ends},
      {"signals", signals},
      {"paced", paced},
      {"edges", edges},
      {"odd", odd},
      {"hot", hot},
      {"objects", objects},
      {"objects-threads", objectsOfThreads},
      {"in-place", inPlace},
      {"turning", turning},
      {"names", names},
      {"closed", closed},
      {"cancelled", cancelled},
      {"exits", exits},
      {"together", together}};
  auto Found = Count > 1 ? Known.find(Words[1]) : Known.end();
  if (Found == Known.end())
    return 2;
  return Found->second(Arguments(Words + 2, Words + Count));
}
