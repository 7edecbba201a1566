// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %link -O0 %t.0.o %t.ros.o -o %t.0
// RUN: %t.0 | FileCheck %s
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %link -O2 %t.2.o %t.ros.o -o %t.2
// RUN: %t.2 | FileCheck %s
//
// A comparison in std::max or std::clamp is reported where it is made, also at
// -O0.
#include <ros/ros.h>

#include <algorithm>

static double Limit;

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  Handle.param("limit", Limit, 2.0);
  double Value = Argc;
  std_msgs::Number Message;
  // max(a, b) is `a < b ? b : a`.
  // CHECK: report 1 cmp 1 thresh 2 res 1
  Message.data = std::max(Value, Limit);
  Out.publish(Message);
  // CHECK-NEXT: published out 2
}
