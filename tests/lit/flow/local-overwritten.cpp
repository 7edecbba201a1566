// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A local variable that is set again before the comparison no longer holds the
// parameter; one that is set again on one path only still can.
#include <ros/ros.h>

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value, bool Odd) {
  double Limit, Kept;
  Handle.param("limit", Limit, 0.5);
  Handle.param("kept", Kept, 0.5);
  Limit = 2;
  if (Odd)
    Kept = 3;
  // CHECK: comparisons of {{.*}}: 1
  // CHECK: parameter 'kept' {{.*}} at [[#@LINE+3]]:13
  if (Value < Limit)
    Out.publish(std_msgs::Number());
  if (Value < Kept)
    Out.publish(std_msgs::Number());
}
