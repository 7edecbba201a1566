// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A service call exposes like a publish.
#include <ros/ros.h>

void step(ros::NodeHandle &Handle, ros::ServiceClient &Arm, double V) {
  double A;
  Handle.param("a", A, 1.0);
  std_msgs::Number Request, Response;
  // CHECK: comparisons of {{.*}}: 1
  // CHECK: 'a' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:
  if (V > A)
    Arm.call(Request, Response);
}
