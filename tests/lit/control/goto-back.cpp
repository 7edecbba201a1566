// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A jump back past the end of a scope: the condition only decides how often it
// is evaluated; the publish behind it happens anyway.
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
  // An object with a destructor lies between, so clang records where to continue.
  std_msgs::Number Message;
  Out.publish(Message);
}
