// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A local that a lambda captures by reference is distinguished from other
// objects of its class.
#include <ros/ros.h>

struct Range {
  double Low = 0;
};

static Range Fixed;

void run(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  Range Own;
  [&] { Handle.getParam("low", Own.Low); }();
  // CHECK: comparisons of {{.*}}: 1
  if (Value > Fixed.Low)
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: parameter 'low' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:13
  if (Value > Own.Low)
    Out.publish(std_msgs::Number());
}
