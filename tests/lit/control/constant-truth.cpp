// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// After inlining, a truth value may be a constant and has no second operand to
// inspect (this crashed).
#include <ros/ros.h>

static __attribute__((always_inline)) bool yes() { return true; }

void step(ros::Publisher &Out, double V) {
  // CHECK: comparisons with constants: 1
  // CHECK: constant '3' {{.*}} at [[#@LINE+1]]:27
  if (yes() == true && (V > 3) == yes())
    Out.publish(std_msgs::Number());
}
