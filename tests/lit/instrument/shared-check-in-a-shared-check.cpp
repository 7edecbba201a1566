// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %s -o %t.o
// RUN: %link -O0 %t.o %t.ros.o -Xlinker -mllvm \
// RUN:   -Xlinker -tpc-max-separated=1 -o %t
// RUN: %t | FileCheck %s
//
// A function that is copied for its calls, and one that it calls, are copied
// together: each copy of the caller has calls of its own.
#include <ros/ros.h>

// The value is 10; low is 1 and high is 100. Each comparison reports once for
// each call of isAllowed(), under the parameter of that call. The search comes
// to isAbove() first, by the read of `middle`.
// CHECK: report 1 cmp 10 thresh 1 res 1
// CHECK-NEXT: report 1 cmp 5 thresh 1 res 1
// CHECK-NEXT: published out 0
// CHECK-NEXT: report 0 cmp 10 thresh 100 res 0
// CHECK-NEXT: report 0 cmp 5 thresh 100 res 0
// CHECK-NEXT: report 1 cmp 10 thresh 3 res 1
// CHECK-NEXT: published out 0
// CHECK-NOT: {{.}}
static __attribute__((noinline)) bool isAbove(double Value, double Threshold) {
  return Value > Threshold;
}

static __attribute__((noinline)) bool isAllowed(double Value, double Limit) {
  bool Above = isAbove(Value, Limit);
  return Limit < 5 && Above;
}

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  double Middle, Low, High;
  Handle.param("middle", Middle, 3.0);
  Handle.param("low", Low, 1.0);
  Handle.param("high", High, 100.0);
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  double Value = 10 * Argc;
  if (isAllowed(Value, Low))
    Out.publish(std_msgs::Number());
  if (isAllowed(Value, High))
    Out.publish(std_msgs::Number());
  if (isAbove(Value, Middle))
    Out.publish(std_msgs::Number());
}
