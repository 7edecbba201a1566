// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A comparison of two parameters is a comparison with each of them.
#include <ros/ros.h>

void step(ros::NodeHandle &Handle, ros::Publisher &Out) {
  double Low, High;
  Handle.param("low", Low, 0.5);
  Handle.param("high", High, 1.5);
  // CHECK: comparisons of {{.*}}: 2
  // CHECK: parameter 'low' relation > {{.*}} at [[#@LINE+2]]:11
  // CHECK: parameter 'high' relation < {{.*}} at [[#@LINE+1]]:11
  if (Low < High)
    Out.publish(std_msgs::Number());
}
