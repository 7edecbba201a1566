// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %link -O0 %t.0.o %t.ros.o -o %t.0
// RUN: %t.0 | FileCheck %s
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %link -O2 %t.2.o %t.ros.o -o %t.2
// RUN: %t.2 | FileCheck %s
//
// If a value is not a number, the outcome is that of the program: every
// comparison is false, except !=.
#include <ros/ros.h>

#include <cmath>

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  double Limit;
  Handle.param("limit", Limit, 2.0);
  double Value = std::sqrt(-static_cast<double>(Argc));
  // CHECK: report 0 cmp {{-?}}nan thresh 2 res 0
  if (Value > Limit)
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: report 0 cmp {{-?}}nan thresh 2 res 0
  if (Value <= Limit)
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: report 0 cmp {{-?}}nan thresh 2 res 0
  if (Value == Limit)
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: report 1 cmp {{-?}}nan thresh 2 res 1
  if (Value != Limit)
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: published out 0
  // CHECK-NEXT: report 0 cmp {{-?}}nan thresh 2 res 0
  if (!(Value < Limit))
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: published
}
