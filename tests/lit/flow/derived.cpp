// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// Arithmetic with constants is recorded: affine as scale and offset, otherwise
// as an expression. See derived-with-variables.cpp for other operands.
#include <ros/ros.h>

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  // CHECK: comparisons of {{.*}}: 4
  double Degrees, Radius, Period;
  int Percent;
  Handle.param("degrees", Degrees, 0.5);
  Handle.param("radius", Radius, 0.5);
  Handle.param("period", Period, 0.5);
  Handle.param("percent", Percent, 5);
  // CHECK-DAG: derived 'degrees' relation > as 0.5 * x + 2 {{.*}} at [[#@LINE+1]]:
  if (Value > Degrees / 2 + 2)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: derived 'radius' relation < as x^2 {{.*}} at [[#@LINE+1]]:
  if (Value < Radius * Radius)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: derived 'period' relation < as 1 / x {{.*}} at [[#@LINE+1]]:
  if (Value < 1 / Period)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: derived 'percent' relation >= as -1 * x + 100 {{.*}} at [[#@LINE+1]]:
  if (static_cast<int>(Value) >= 100 - Percent)
    Out.publish(std_msgs::Number());
}
