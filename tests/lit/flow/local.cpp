// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A parameter in a local variable.
#include <ros/ros.h>

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double Limit;
  Handle.param("limit", Limit, 0.5);
  // CHECK: comparisons of {{.*}}: 1
  // CHECK: parameter 'limit' relation < as x distance 1 others 0 in {{.*}} at [[#@LINE+1]]:13
  if (Value < Limit)
    Out.publish(std_msgs::Number());
}
