// A node that reports at a given rate, and says `ready` before. It stops when
// its time is up or when it is told to, and then says on standard output how
// many reports it made: `made before=N running=N after=N`.
//
// reporter --before=N --rate=N --seconds=S --threads=N --after=N --fork=N
//          --fork-wait=S --wait=S --stay=S --shutdown=0|1 --flops=0|1

#include <ros/ros.h>
#include <tpc/LogOne.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

using Clock = std::chrono::steady_clock;

static double option(int Count, char **Words, const char *Name,
                     double Otherwise) {
  const std::string Start = std::string("--") + Name + "=";
  for (int I = 1; I < Count; ++I)
    if (!std::strncmp(Words[I], Start.c_str(), Start.size()))
      return std::atof(Words[I] + Start.size());
  return Otherwise;
}

/// Keys are UUIDs: 1 before ros::init, 2 after ros::shutdown, 3 in a child, 4
/// before the fork, 100 and more for the threads.
static std::string key(int Number) {
  char Text[40];
  std::snprintf(Text, sizeof(Text), "%08d-0000-4000-8000-000000000000", Number);
  return Text;
}

/// The I-th report of a key: its number is the compared value.
static void report(const std::string &Key, long I, bool Flops) {
  const bool Result = Flops && I % 2;
  log_one(const_cast<char *>(Key.c_str()), Result, static_cast<double>(I), 0.5,
          Result);
}

static std::atomic<long> Made{0};

/// Reports at \p Rate a second, in portions of a millisecond or longer.
static void run(const std::string &Key, double Rate, double Seconds,
                bool Flops) {
  const auto Begin = Clock::now();
  long I = 0;
  while (ros::ok()) {
    const double Since =
        std::chrono::duration<double>(Clock::now() - Begin).count();
    for (; I < std::min(Since, Seconds) * Rate && ros::ok(); ++I)
      report(Key, I, Flops);
    if (Since > Seconds)
      break;
    std::this_thread::sleep_for(
        std::chrono::duration<double>(std::max(1e-3, 1 / Rate)));
  }
  Made += I;
}

int main(int Count, char **Words) {
  const auto Option = [&](const char *Name, double Otherwise) {
    return option(Count, Words, Name, Otherwise);
  };
  const bool Flops = Option("flops", 0) != 0;
  const long Before = Option("before", 0), After = Option("after", 0);
  for (long I = 0; I < Before; ++I)
    report(key(1), I, Flops);
  ros::init(Count, Words, "reporter");
  {
    ros::NodeHandle Node;
    ros::AsyncSpinner Spinner(1);
    Spinner.start();
    if (const long Children = Option("fork", 0); Children > 0) {
      // roscpp hangs in a child that ends otherwise than by _exit.
      report(key(4), 0, Flops);
      std::this_thread::sleep_for(
          std::chrono::duration<double>(Option("fork-wait", 0)));
      if (const pid_t Child = fork(); Child == 0) {
        for (long I = 0; I < Children; ++I)
          report(key(3), I, Flops);
        _exit(0);
      } else {
        int Status = -1;
        waitpid(Child, &Status, 0);
        std::printf("child ended with %d\n", Status);
      }
    }
    // For subscribers to come: /rosout loses what is said before.
    std::this_thread::sleep_for(
        std::chrono::duration<double>(Option("wait", 0)));
    std::puts("ready");
    std::fflush(stdout);
    std::vector<std::thread> Threads;
    const int Number = static_cast<int>(Option("threads", 1));
    for (int I = 0; I < Number; ++I)
      Threads.emplace_back(run, key(100 + I), Option("rate", 100) / Number,
                           Option("seconds", 1), Flops);
    for (std::thread &T : Threads)
      T.join();
    const auto Leave =
        Clock::now() +
        std::chrono::milliseconds(static_cast<long>(1e3 * Option("stay", 0)));
    while (ros::ok() && Clock::now() < Leave)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    Spinner.stop();
    if (Option("shutdown", 1) != 0)
      ros::shutdown();
    for (long I = 0; I < After; ++I)
      report(key(2), I, Flops);
    std::printf("made before=%ld running=%ld after=%ld\n", Before, Made.load(),
                After);
    std::fflush(stdout);
  }
  return 0;
}
