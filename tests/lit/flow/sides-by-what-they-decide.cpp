// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A parameter is reported on the side where one call has it, even if a shorter path
// in another call, whose outcome decides something else, has it on the other side.
#include <ros/ros.h>

static int Limit, Kept;

static bool less(int Left, int Right) {
  // CHECK: comparisons of {{.*}}: 2
  // CHECK-DAG: parameter 'limit' relation > as x distance 2 {{.*}} at [[#@LINE+2]]:15
  // CHECK-DAG: parameter 'limit' relation < as x distance 1 {{.*}} at [[#@LINE+1]]:15
  return Left < Right;
}

void run(ros::NodeHandle &Handle, ros::Publisher &Out, int Count) {
  Handle.param("limit", Limit, 1);
  Kept = Limit;
  if (less(Count, Kept))
    Out.publish(std_msgs::Number());
  if (less(Limit, Count))
    if (Count > 7)
      Out.publish(std_msgs::Number());
}
