// A node whose own handler of SIGINT shuts it down, as amcl and others have it,
// whatever the thread that it interrupts is doing. Its main thread and two
// others report without a pause. Says `ready` once they do.

#include <ros/ros.h>
#include <tpc/LogOne.h>

#include <csignal>
#include <cstdio>
#include <thread>

static void report(int Number) {
  char Key[40];
  std::snprintf(Key, sizeof(Key), "%08d-0000-4000-8000-000000000000", Number);
  for (long I = 0; ros::ok(); ++I)
    log_one(Key, I % 3 == 0, static_cast<double>(I), 0.5, true);
}

int main(int Count, char **Words) {
  ros::init(Count, Words, "interrupted", ros::init_options::NoSigintHandler);
  ros::NodeHandle Node;
  std::signal(SIGINT, [](int) { ros::shutdown(); });
  ros::AsyncSpinner Spinner(1);
  Spinner.start();
  std::thread First(report, 1), Second(report, 2);
  std::puts("ready");
  std::fflush(stdout);
  report(3);
  First.join();
  Second.join();
  return 0;
}
