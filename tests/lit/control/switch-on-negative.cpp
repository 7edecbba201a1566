// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A narrow signed constant keeps its sign when a switch takes it: the predicate
// decides which case is taken.
// CHECK: comparisons of {{.*}}: 1
// CHECK-NEXT: parameter 'limit' relation > as x distance 1
#include <ros/ros.h>

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double Limit = 0;
  Handle.param("limit", Limit, 1.0);
  signed char State;
  if (Value > Limit)
    State = -1;
  else
    State = 1;
  switch (State) {
  case -1:
    break;
  default:
    Out.publish(std_msgs::Number());
  }
}
