// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %s -o %t.o
// RUN: %link -O2 %t.o %t.ros.o -o %t
// RUN: %t | FileCheck %s
//
// Exceptions pass through instrumented code as before.
// CHECK: report 0 cmp 1 thresh 2 res 0
// CHECK-NEXT: published out 1
// CHECK-NEXT: report 1 cmp 3 thresh 2 res 1
// CHECK-NEXT: published caught 3
#include <ros/ros.h>

static double Limit;

static void step(ros::Publisher &Out, double V) {
  std_msgs::Number Message;
  Message.data = V;
  if (V > Limit)
    throw V;
  Out.publish(Message);
}

int main() {
  ros::NodeHandle Handle;
  Handle.param("limit", Limit, 2.0);
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  ros::Publisher Caught = Handle.advertise<std_msgs::Number>("caught", 1);
  try {
    step(Out, 1);
    step(Out, 3);
  } catch (double V) {
    std_msgs::Number Message;
    Message.data = V;
    Caught.publish(Message);
  }
}
