// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// Each operand of && and || is a predicate; all belong to one condition. A
// nested if is another condition.
#include <ros/ros.h>

// CHECK: comparisons of {{.*}}: 5
void step(ros::NodeHandle &Handle, ros::Publisher &Out, double V, double W) {
  double A, B, C, D, E;
  Handle.param("a", A, 1.0);
  Handle.param("b", B, 2.0);
  Handle.param("c", C, 3.0);
  Handle.param("d", D, 4.0);
  Handle.param("e", E, 5.0);
  // CHECK-DAG: 'a' relation > as x distance 2 others 2 {{.*}} at [[#@LINE+3]]:10
  // CHECK-DAG: 'b' relation < as x distance 1 others 2 {{.*}} at [[#@LINE+2]]:19
  // CHECK-DAG: 'c' relation > as x distance 1 others 2 {{.*}} at [[#@LINE+1]]:29
  if ((V > A && V < B) || W > C)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: 'd' {{.*}} distance 2 others 0 {{.*}} at [[#@LINE+1]]:9
  if (V > D) {
    // CHECK-DAG: 'e' {{.*}} distance 1 others 0 {{.*}} at [[#@LINE+1]]:11
    if (V < E)
      Out.publish(std_msgs::Number());
  }
}
