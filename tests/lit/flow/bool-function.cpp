// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A comparison inside a function that returns its outcome, by value and by
// early return.
#include <ros/ros.h>

static double Limit;

static bool enough(double Value) {
  // CHECK-DAG: 'limit' relation > {{.*}} in _ZL6enoughd at [[#@LINE+1]]:16
  return Value > Limit;
}

static bool tooMuch(double Value) {
  // CHECK-DAG: 'limit' relation < {{.*}} in _ZL7tooMuchd at [[#@LINE+1]]:13
  if (Value < Limit)
    return false;
  return true;
}

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  Handle.param("limit", Limit, 0.5);
  if (enough(Value) && !tooMuch(Value - 1))
    Out.publish(std_msgs::Number());
}
