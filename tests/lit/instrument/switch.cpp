// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %link -O0 %t.0.o %t.ros.o -o %t.0
// RUN: %t.0 | FileCheck %s
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %link -O2 %t.2.o %t.ros.o -o %t.2
// RUN: %t.2 | FileCheck %s
//
// A switch on a parameter reports its value, and whether a case is taken.
#include <ros/ros.h>

static void step(ros::Publisher &Out, int Mode) {
  switch (Mode) {
  case -3:
    Out.publish(std_msgs::Number());
    break;
  case 2:
    break;
  default:
    Out.publish(std_msgs::Number());
  }
}

int main() {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  int A, B;
  Handle.param("a", A, -3);
  Handle.param("b", B, 7);
  // CHECK: report 1 cmp -3 thresh -3 res 1
  // CHECK-NEXT: published
  step(Out, A);
  // CHECK-NEXT: report 0 cmp 7 thresh 7 res 0
  // CHECK-NEXT: published
  step(Out, B);
}
