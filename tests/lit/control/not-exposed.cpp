// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// No exposing statement depends on these: the branch only counts, only logs, or
// the publish happens anyway.
#include <ros/ros.h>
#include <cstdio>

static int Count;

// CHECK: comparisons of {{.*}}: 0
void step(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  double A;
  Handle.param("a", A, 1.0);
  if (V > A)
    ++Count;
  if (V < A)
    std::puts("low");
  if (V > A)
    std::puts("now");
  else
    std::puts("anyway");
  Out.publish(std_msgs::Number());
}
