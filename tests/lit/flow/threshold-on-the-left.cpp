// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// The relation is given with the threshold on the right, whichever side it is
// on in the source.
#include <ros/ros.h>

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double Limit;
  Handle.param("limit", Limit, 0.5);
  // CHECK: parameter 'limit' relation <= {{.*}} at [[#@LINE+1]]:
  if (Limit >= Value)
    Out.publish(std_msgs::Number());
}
