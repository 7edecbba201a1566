// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// An early return decides whether what follows is published.
#include <ros/ros.h>

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double Limit;
  Handle.param("limit", Limit, 0.5);
  // CHECK: comparisons of {{.*}}: 1
  // CHECK: 'limit' {{.*}} distance 1 {{.*}} at [[#@LINE+1]]:
  if (Value > Limit)
    return;
  Out.publish(std_msgs::Number());
}
