// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %link -O0 %t.0.o %t.ros.o -o %t.0
// RUN: %t.0 | FileCheck %s
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %link -O2 %t.2.o %t.ros.o -o %t.2
// RUN: %t.2 | FileCheck %s
//
// A function that compares its argument reports for each call under the
// parameter of that call, and does not report for a call that passes none.
#include <ros/ros.h>

// Low is 1 and high is 100; with 10 the first call is true, the second false.
// CHECK: report 1 cmp 10 thresh 1 res 1 key [[LOW:....]]
// CHECK-NEXT: published out 0
// CHECK-NEXT: report 0 cmp 10 thresh 100 res 0
// CHECK-NEXT: published out 0
// CHECK-NOT: {{.}}
static __attribute__((noinline)) bool above(double Value, double Threshold) {
  return Value > Threshold;
}

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  double Low, High;
  Handle.param("low", Low, 1.0);
  Handle.param("high", High, 100.0);
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  double Value = 10 * Argc;
  if (above(Value, Low))
    Out.publish(std_msgs::Number());
  if (above(Value, High))
    Out.publish(std_msgs::Number());
  if (above(Value, 3.0))
    Out.publish(std_msgs::Number());
}
