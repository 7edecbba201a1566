// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// Both operands lead to the same return, so both choose the returned value,
// although a scope is cleaned up in between. The branch is in round 2, the
// comparison in 3, the call in 4, the return in 5, the value in 6.
#include <ros/ros.h>

static double chosen(double Value, double First, double Second) {
  {
    std::string Text("text");
    // CHECK: 'first' relation > as x distance 6
    // CHECK: 'second' relation > as x distance 6
    if (Value > First || Value > Second)
      return Value;
  }
  return 2 * Value;
}

void run(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double First = 0, Second = 0;
  Handle.getParam("first", First);
  Handle.getParam("second", Second);
  if (chosen(Value, First, Second) > 1)
    Out.publish(std_msgs::Number());
}
