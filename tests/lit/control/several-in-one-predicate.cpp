// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// Comparisons that are combined without short circuit form one predicate.
#include <ros/ros.h>

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  double A, B;
  Handle.param("a", A, 1.0);
  Handle.param("b", B, 2.0);
  // CHECK: comparisons of {{.*}}: 2
  // CHECK: 'a' relation > as x distance 1 others 1 {{.*}} at [[#@LINE+2]]:10
  // CHECK: 'b' relation < as x distance 1 others 1 {{.*}} at [[#@LINE+1]]:20
  if ((V > A) & (V < B))
    Out.publish(std_msgs::Number());
}
