// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A parameter's value that is passed to a function by value and by reference,
// and a variable that a function reads it into.
#include <ros/ros.h>

static bool above(double Value, double Threshold) {
  // CHECK-DAG: parameter 'by_value' {{.*}} in _ZL5abovedd at [[#@LINE+1]]:16
  return Value > Threshold;
}

static bool below(double Value, const double &Threshold) {
  // CHECK-DAG: parameter 'by_reference' {{.*}} at [[#@LINE+1]]:16
  return Value < Threshold;
}

static void load(ros::NodeHandle &Handle, double &Into) {
  Handle.param("out", Into, 0.5);
}

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double A, B, C;
  Handle.param("by_value", A, 0.5);
  Handle.param("by_reference", B, 0.5);
  load(Handle, C);
  if (above(Value, A))
    Out.publish(std_msgs::Number());
  if (below(Value, B))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'out' {{.*}} at [[#@LINE+1]]:13
  if (Value > C)
    Out.publish(std_msgs::Number());
}
