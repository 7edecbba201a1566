//===- Loop.cpp - A node that does nothing but compare
//---------------------===//
//
// What one report costs: values are compared with a parameter, and the time of
// that is written to a file. One source for all ways: built plainly; built with
// TPC, whose plugin inserts the reports; or with REPORT_BY_HAND, where they
// stand in the source as the plugin leaves them, for log_one of somebody else
// (Thesis.cpp, StringPublish.cpp, Lttng.cpp).
//
//   Loop OUTPUT WORK MODE BLOCKS COUNT GAP_US FLOPS
//
// WORK is bare (the comparison alone) or filter (with a low-pass filter, the
// least that a control loop does). FLOPS is how many of a million comparisons
// flop. MODE `block` times COUNT comparisons together, BLOCKS times, with
// GAP_US before each block; `single` times each of them alone, as a thread of
// real-time priority where that is allowed, with GAP_US before each block, too;
// `paced` waits GAP_US before each comparison. OUTPUT gets nanoseconds of one
// comparison as native doubles.
//
//===----------------------------------------------------------------------===//
#include <ros/ros.h>
#include <std_msgs/UInt64.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <sched.h>
#include <string>
#include <vector>

#ifdef REPORT_BY_HAND
#include "ByHand.h"
#define REPORT(VALUE, LIMIT)                                                   \
  if (Reporting)                                                               \
  log_one(const_cast<char *>("6f1e0c0e-54c8-5b9b-8f0a-7d7f1c5f2a10"),          \
          VALUE > LIMIT, VALUE, LIMIT, VALUE > LIMIT)
#else
#define REPORT(VALUE, LIMIT) (void)0
#endif

namespace {

int64_t now() {
  timespec T;
  clock_gettime(CLOCK_MONOTONIC, &T);
  return T.tv_sec * 1000000000LL + T.tv_nsec;
}

void sleepUntil(int64_t At) {
  const timespec T{At / 1000000000, At % 1000000000};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &T, nullptr);
}

/// The node: what it counts is published, and depends on the comparisons.
class Monitor {
public:
  explicit Monitor(ros::NodeHandle Node)
      : Out(Node.advertise<std_msgs::UInt64>("hits", 1)) {
    Node.param("limit", Limit, 1.0);
  }

  __attribute__((noinline)) void bare(const double *Values, size_t Count) {
    for (size_t I = 0; I < Count; ++I) {
      const double Value = Values[I];
      const double Bound = limit();
      REPORT(Value, Bound);
      if (Value > Bound)
        ++Hits;
    }
  }

  __attribute__((noinline)) void filter(const double *Values, size_t Count) {
    for (size_t I = 0; I < Count; ++I) {
      const double Value = Values[I];
      Trend += 0.25 * (Value - Trend);
      const double Bound = limit();
      REPORT(Value, Bound);
      if (Value > Bound)
        ++Hits;
    }
  }

  void steps(const double *Values, size_t Count) {
    for (size_t I = 0; I < Count; ++I)
      step(Values[I]);
  }

  __attribute__((noinline)) void step(double Value) {
    Trend += 0.25 * (Value - Trend);
    const double Bound = limit();
    REPORT(Value, Bound);
    if (Value > Bound)
      ++Hits;
  }

  void publish() {
    std_msgs::UInt64 Message;
    Message.data = Hits;
    Out.publish(Message);
  }

  double trend() const { return Trend; }

private:
  /// Read anew each time, as a parameter is that may be changed.
  double limit() const { return *static_cast<const volatile double *>(&Limit); }

  ros::Publisher Out;
  double Limit = 1.0;
  double Trend = 0.0;
  uint64_t Hits = 0;
};

using Work = void (Monitor::*)(const double *, size_t);

/// Below the limit of 1 by 0.5 to 1 or above it by as much, changing sides
/// FlopsPerMillion times in a million values; ends where it began, so that it
/// can be repeated.
std::vector<double> values(size_t Count, double FlopsPerMillion) {
  std::vector<double> Made(Count);
  uint32_t Random = 1;
  double Due = 0.0;
  double Side = -1.0;
  for (double &Value : Made) {
    Due += FlopsPerMillion / 1e6;
    if (Due >= 1.0) {
      Due -= 1.0;
      Side = -Side;
    }
    Random = Random * 1664525u + 1013904223u;
    Value = 1.0 + Side * (0.5 + 0.5 * (Random >> 8) / 16777216.0);
  }
  return Made;
}

/// This thread alone, so that what helps it keeps the other processors.
void pinToLastProcessor() {
  cpu_set_t Set;
  sched_getaffinity(0, sizeof(Set), &Set);
  for (int Number = CPU_SETSIZE - 1; Number >= 0; --Number)
    if (CPU_ISSET(Number, &Set)) {
      CPU_ZERO(&Set);
      CPU_SET(Number, &Set);
      sched_setaffinity(0, sizeof(Set), &Set);
      return;
    }
}

} // namespace

int main(int Argc, char **Argv) {
  ros::init(Argc, Argv, "loop", ros::init_options::AnonymousName);
  if (Argc != 8) {
    std::fprintf(stderr, "usage: Loop OUTPUT WORK MODE BLOCKS COUNT GAP_US "
                         "FLOPS\n");
    return 2;
  }
  const std::string Mode = Argv[3];
  const std::string Name = Argv[2];
  const Work Run = Name == "filter" ? &Monitor::filter
                   : Name == "step" ? &Monitor::steps
                                    : &Monitor::bare;
  const size_t Blocks = std::strtoul(Argv[4], nullptr, 10);
  const size_t Count = std::strtoul(Argv[5], nullptr, 10);
  const int64_t Gap = std::strtol(Argv[6], nullptr, 10) * 1000;
  const std::vector<double> Values = values(Count, std::atof(Argv[7]));

  ros::NodeHandle Node("~");
  Monitor M(Node);
  // The first reports make threads and connections, which are not pinned; then
  // half a second for subscribers to connect.
  (M.*Run)(Values.data(), 1);
  for (int I = 0; I < 25; ++I) {
    ros::spinOnce();
    sleepUntil(now() + 20000000);
  }
  pinToLastProcessor();

  if (Mode == "single") {
    const sched_param Priority{sched_get_priority_min(SCHED_FIFO)};
    sched_setscheduler(0, SCHED_FIFO, &Priority);
  }

  std::vector<double> Taken;
  Taken.reserve(Mode == "block" ? Blocks : Blocks * Count);
  // Its pages are touched ahead: a fault would be taken for a report's.
  Taken.assign(Taken.capacity(), 0.0);
  Taken.clear();
  for (size_t Block = 0; Block < Blocks; ++Block) {
    if (Gap && Mode != "paced")
      sleepUntil(now() + Gap);
    if (Mode == "block") {
      const int64_t Begin = now();
      (M.*Run)(Values.data(), Count);
      Taken.push_back(double(now() - Begin) / double(Count));
      continue;
    }
    int64_t Next = now();
    for (size_t I = 0; I < Count; ++I) {
      if (Mode == "paced")
        sleepUntil(Next += Gap);
      const int64_t Begin = now();
      (M.*Run)(&Values[I], 1);
      Taken.push_back(double(now() - Begin));
    }
  }
  M.publish();

  std::FILE *Output = std::fopen(Argv[1], "wb");
  if (!Output)
    return 1;
  std::fwrite(Taken.data(), sizeof(double), Taken.size(), Output);
  if (std::fclose(Output))
    return 1;
  // So that the filter is not left out.
  return M.trend() == 0.5 ? 3 : 0;
}
