// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// The other way of a branch exposes, not the one that the condition is true
// on.
#include <ros/ros.h>

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double Limit, Seen = 0;
  Handle.param("limit", Limit, 0.5);
  // CHECK: parameter 'limit' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:
  if (Value > Limit)
    Seen += 1;
  else
    Out.publish(std_msgs::Number());
}
