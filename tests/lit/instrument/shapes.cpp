// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %link -O0 %t.0.o %t.ros.o -o %t.0
// RUN: %t.0 | FileCheck %s
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %link -O2 %t.2.o %t.ros.o -o %t.2
// RUN: %t.2 | FileCheck %s
//
// bool == bool is a comparison; a predicate is reported without the `!` before
// it; `?:` is a predicate; each operand of && and || is a predicate of its own.
#include <ros/ros.h>

#include <cmath>

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  bool Wanted;
  double Limit;
  int Most;
  float Near;
  Handle.param("wanted", Wanted, true);
  Handle.param("limit", Limit, 2.0);
  Handle.param("most", Most, 3);
  Handle.param("near", Near, 0.5f);
  bool Is = Argc > 5;
  // CHECK: report 0 cmp 0 thresh 1 res 0
  if (Is == Wanted)
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: report 0 cmp 1 thresh 2 res 0
  if (!(Argc > Limit))
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: published out 0
  // CHECK-NEXT: report 0 cmp 1 thresh 2 res 0
  bool Few = !(Argc > Limit);
  if (Few)
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: published out 0
  std_msgs::Number Message;
  // CHECK-NEXT: report 0 cmp 1 thresh 2 res 0
  Message.data = Argc > Limit ? 4 : 5;
  Out.publish(Message);
  // CHECK-NEXT: published out 5
  // CHECK-NEXT: report 1 cmp 1 thresh 2 res 1
  // CHECK-NEXT: report 0 cmp 1 thresh 3 res 0
  if (Argc < Limit && Argc >= Most)
    Out.publish(Message);
  // CHECK-NEXT: report 0 cmp 1 thresh 2 res 0
  // CHECK-NEXT: report 1 cmp 1 thresh 3 res 1
  bool Either = Argc > Limit || Argc < Most;
  if (Either)
    Out.publish(Message);
  // CHECK-NEXT: published out 5
  // CHECK-NEXT: report 1 cmp 1 thresh 0.5 res 1
  if (std::abs(-1.0f * Argc) > Near)
    Out.publish(Message);
}
