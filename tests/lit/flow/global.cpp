// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A parameter in a global variable, and in the first and second field of a
// global object: an access to the first field has no getelementptr.
#include <ros/ros.h>

double Limit;
struct {
  double First, Second;
} Both;

void load(ros::NodeHandle &Handle) {
  Handle.param("limit", Limit, 0.5);
  Handle.param("first", Both.First, 0.5);
  Handle.param("second", Both.Second, 0.5);
}

// CHECK: comparisons of {{.*}}: 3
void step(ros::Publisher &Out, double Value) {
  // CHECK-NEXT: parameter 'limit' {{.*}} at [[#@LINE+1]]:13
  if (Value < Limit)
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: parameter 'first' {{.*}} at [[#@LINE+1]]:13
  if (Value < Both.First)
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: parameter 'second' {{.*}} at [[#@LINE+1]]:13
  if (Value < Both.Second)
    Out.publish(std_msgs::Number());
}
