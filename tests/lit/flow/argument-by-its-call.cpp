// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A value that enters a shared function by one call leaves it by the same call:
// the other caller does not compare a parameter.
#include <ros/ros.h>

static double same(double X) { return X; }

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double Limit;
  Handle.param("limit", Limit, 0.5);
  // CHECK: comparisons of {{.*}}: 1
  // CHECK: parameter 'limit' {{.*}} at [[#@LINE+1]]:13
  if (Value > same(Limit))
    Out.publish(std_msgs::Number());
  if (Value > same(7))
    Out.publish(std_msgs::Number());
}
