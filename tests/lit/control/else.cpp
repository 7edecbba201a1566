// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// The else branch exposes, not the branch taken if the condition is
// true.
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
