// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A parameter that one call brings to the other side, with an outcome that
// decides nothing, is reported where the outcome of another call decides.
#include <ros/ros.h>

static int Limit;

static bool above(int Count) {
  // CHECK: comparisons of {{.*}}: 1
  // CHECK: derived 'limit' relation > as x^2 distance 1 {{.*}} at [[#@LINE+1]]:24
  return Limit * Limit < Count;
}

void run(ros::NodeHandle &Handle, ros::Publisher &Out) {
  Handle.param("limit", Limit, 1);
  above(Limit);
  if (above(30))
    Out.publish(std_msgs::Number());
}
