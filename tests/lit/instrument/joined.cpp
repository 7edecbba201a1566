// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %link -O0 %t.0.o %t.ros.o -o %t.0
// RUN: %t.0 | FileCheck %s
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %link -O2 %t.2.o %t.ros.o -o %t.2
// RUN: %t.2 | FileCheck %s
//
// Comparisons that form one predicate without control flow: result is the
// outcome of the predicate, res that of the comparison; also if the predicate
// is in the caller.
#include <ros/ros.h>

static double Low, High;

static __attribute__((noinline)) bool outside(double V) {
  return (V < Low) | (V > High);
}

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  Handle.param("low", Low, 0.5);
  Handle.param("high", High, 0.75);
  double Value = Argc;
  bool AboveLow = Value > Low, BelowHigh = Value < High;
  // CHECK: report 0 cmp 1 thresh 0.5 res 1
  // CHECK-NEXT: report 0 cmp 1 thresh 0.75 res 0
  if (AboveLow & BelowHigh)
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: report 1 cmp 1 thresh 0.5 res 0
  // CHECK-NEXT: report 1 cmp 1 thresh 0.75 res 1
  if (outside(Value))
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: published
}
