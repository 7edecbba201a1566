// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// Nothing depends on whether a call can throw; code behind an explicit throw
// under a condition depends on the condition.
#include <ros/ros.h>

void mayThrow();

// CHECK: comparisons of {{.*}}: 1
void step(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  double A, B;
  int Logged = 0;
  Handle.param("a", A, 1.0);
  Handle.param("b", B, 1.0);
  if (V > A) {
    mayThrow();
    ++Logged;
  }
  // CHECK: 'b' {{.*}} distance 1 {{.*}} at [[#@LINE+1]]:
  if (V > B)
    throw Logged;
  Out.publish(std_msgs::Number());
}
