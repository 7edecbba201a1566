// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A jump back past the end of a scope: all that the condition decides is how
// often it is asked, the publish behind it happens anyway.
#include <ros/ros.h>

double sensed();

// CHECK: comparisons of {{.*}}: 0
void step(ros::NodeHandle &Handle, ros::Publisher &Out) {
  double Limit;
  Handle.param("limit", Limit, 0.5);
again:
  double Value = sensed();
  if (Value > Limit)
    goto again;
  // Something with an end of life lies between, so clang notes where to go on.
  std_msgs::Number Message;
  Out.publish(Message);
}
