// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A parameter that is itself the condition: bool, negated, and an integer.
#include <ros/ros.h>

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  bool UseGps, Quiet;
  int Count = 0;
  Handle.param("use_gps", UseGps, true);
  Handle.param("quiet", Quiet, false);
  Handle.getParam("count", Count);
  // CHECK: comparisons of {{.*}}: 3
  // CHECK: flag 'use_gps' relation flag {{.*}} at [[#@LINE+1]]:7
  if (UseGps)
    Out.publish(std_msgs::Number());
  // CHECK: flag 'quiet' relation flag {{.*}} at [[#@LINE+1]]:
  if (!Quiet)
    Out.publish(std_msgs::Number());
  // CHECK: flag 'count' relation flag {{.*}} at [[#@LINE+1]]:7
  if (Count)
    Out.publish(std_msgs::Number());
}
