// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %link -O0 %t.0.o %t.ros.o -o %t.0
// RUN: %t.0 | FileCheck %s
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %link -O2 %t.2.o %t.ros.o -o %t.2
// RUN: %t.2 | FileCheck %s
//
// A comparison whose outcome is published, in the same function or by a caller,
// is reported where it is evaluated.
#include <ros/ros.h>

static double Low, High;

static __attribute__((noinline)) bool isBelow(double V) { return V < High; }

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  Handle.param("low", Low, 0.5);
  Handle.param("high", High, 0.75);
  std_msgs::Number Message;
  // CHECK: report 1 cmp 1 thresh 0.5 res 1
  // CHECK-NEXT: published
  Message.data = Argc > Low;
  Out.publish(Message);
  // CHECK-NEXT: report 0 cmp 1 thresh 0.75 res 0
  // CHECK-NEXT: published
  Message.data = isBelow(Argc);
  Out.publish(Message);
}
