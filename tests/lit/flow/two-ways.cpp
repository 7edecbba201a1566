// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// If there are several paths to a comparison, the one with the simplest
// arithmetic is reported, whichever comes first.
#include <ros/ros.h>

bool chance();

void run(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double First = 0, Second = 0;
  Handle.getParam("first", First);
  Handle.getParam("second", Second);
  double A = First, B = 2 * Second;
  if (chance())
    A = 2 * First;
  if (chance())
    B = Second;
  // CHECK: parameter 'first' relation > as x distance
  if (Value > A)
    Out.publish(std_msgs::Number());
  // CHECK: parameter 'second' relation > as x distance
  if (Value > B)
    Out.publish(std_msgs::Number());
}
