// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// while, for and do: the condition decides how often the body exposes.
#include <ros/ros.h>

// CHECK: comparisons of {{.*}}: 3
void step(ros::NodeHandle &Handle, ros::Publisher &Out, int Value) {
  int A, B, C;
  Handle.param("a", A, 1);
  Handle.param("b", B, 2);
  Handle.param("c", C, 3);
  // CHECK: 'a' relation < as x distance 1 {{.*}} at [[#@LINE+1]]:
  while (Value < A) {
    Out.publish(std_msgs::Number());
    ++Value;
  }
  // CHECK: 'b' relation < as x distance 1 {{.*}} at [[#@LINE+1]]:
  for (int I = 0; I < B; ++I)
    Out.publish(std_msgs::Number());
  do {
    Out.publish(std_msgs::Number());
    --Value;
    // CHECK: 'c' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:
  } while (Value > C);
}
