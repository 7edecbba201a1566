//===- Reports.cpp - A node that only reports -----------------------------===//
//
// Prints the nanoseconds of one report: the median of blocks of reports, made
// by a node of roscpp (with ROS1), or by one on rcl alone.
//
//===----------------------------------------------------------------------===//
#include "LogOne.h"

#ifdef ROS1
#include <ros/ros.h>
#else
#include <rcl/rcl.h>
#endif

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

static char Key[] = "00000001-0000-5000-8000-000000000000";

int main(int Count, char **Words) {
#ifdef ROS1
  ros::init(Count, Words, "reports", ros::init_options::AnonymousName);
  ros::NodeHandle Node;
#else
  rcl_allocator_t Allocator = rcl_get_default_allocator();
  rcl_init_options_t Options = rcl_get_zero_initialized_init_options();
  rcl_context_t Context = rcl_get_zero_initialized_context();
  rcl_node_t Node = rcl_get_zero_initialized_node();
  const rcl_node_options_t Of = rcl_node_get_default_options();
  if (rcl_init_options_init(&Options, Allocator) ||
      rcl_init(Count, Words, &Options, &Context) ||
      rcl_node_init(&Node, "reports", "", &Context, &Of))
    return 1;
#endif
  constexpr int Blocks = 60, Reports = 20000;
  std::vector<double> Taken;
  // The first report makes threads and files.
  log_one(Key, 0, 0.0, 0.5, 0);
  for (int Block = 0; Block < Blocks; ++Block) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const auto Begin = std::chrono::steady_clock::now();
    for (int I = 0; I < Reports; ++I)
      log_one(Key, I % 2, static_cast<double>(I), 0.5, I % 2);
    const std::chrono::duration<double, std::nano> Time =
        std::chrono::steady_clock::now() - Begin;
    Taken.push_back(Time.count() / Reports);
  }
  std::nth_element(Taken.begin(), Taken.begin() + Blocks / 2, Taken.end());
  std::printf("%f\n", Taken[Blocks / 2]);
  std::fflush(stdout);
}
