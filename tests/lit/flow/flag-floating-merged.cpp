// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %s -o %t.o
// RUN: %link -O2 %t.o %t.ros.o -o %t
// RUN: %t | FileCheck %s
//
// A floating-point parameter that is merged with another value and then decides
// as an integer is reported where it is read, by whether it is not zero.
// CHECK: report 1 cmp 2.5 thresh 2.5 res 1
// CHECK: published out 0
#include <ros/ros.h>

int main() {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  double Mode;
  Handle.param("mode", Mode, 2.5);
  double Use = Handle.getParam("no such", Mode) ? 1.0 : Mode;
  switch (static_cast<int>(Use)) {
  case 2:
    Out.publish(std_msgs::Number());
  }
}
