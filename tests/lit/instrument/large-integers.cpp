// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %link -O0 %t.0.o %t.ros.o -o %t.0
// RUN: %t.0 | FileCheck %s
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %link -O2 %t.2.o %t.ros.o -o %t.2
// RUN: %t.2 | FileCheck %s
//
// Integers that no double can hold: the outcome is exact, the values are rounded.
#include <ros/ros.h>

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  int N;
  Handle.param("n", N, 1);
  // 2^53 + 1 rounds to 2^53, and 2^53 < 2^53 + 1.
  long Value = 9007199254740991 + Argc;
  // CHECK: report 1 cmp 9007199254740992 thresh 9007199254740992 res 1
  if (Value < 9007199254740992 + N)
    Out.publish(std_msgs::Number());
  // CHECK: report 0 cmp 9007199254740992 thresh 9007199254740992 res 0
  if (Value == 9007199254740992 + N)
    Out.publish(std_msgs::Number());
}
