// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A local variable that is read through a reference which may lead to another one
// (the result of std::clamp) holds what was written before the read, not after.
#include <ros/ros.h>

#include <algorithm>

void touch(double &What);

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double V, double W) {
  touch(V);
  if (W > std::clamp(V, 0.5, 10.0))
    Out.publish(std_msgs::Number());
  Handle.getParam("limit", V);
  // The two comparisons of std::clamp, and the one with its result.
  // CHECK: comparisons of {{.*}}: 3
  // CHECK-DAG: parameter 'limit' relation > {{.*}} at [[#@LINE+3]]:11
  // CHECK-DAG: derived 'limit' relation < {{.*}} at [[#@LINE+2]]:11
  // CHECK-DAG: derived 'limit' relation > {{.*}} at [[#@LINE+1]]:9
  if (W > std::clamp(V, 0.5, 10.0))
    Out.publish(std_msgs::Number());
}
