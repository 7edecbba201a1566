// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A local variable that a lambda captures stays the same variable: code behind
// a write of its own function sees the value, code before it does not, and a
// replaced value is gone. What the lambda writes may be seen anywhere.
#include <ros/ros.h>

double sensed();

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Limit,
          double Lower) {
  if (sensed() > Limit) {
    Handle.param("limit", Limit, 0.5);
    Handle.param("lower", Lower, 0.5);
    Out.publish(std_msgs::Number());
  }
  double Upper = 1;
  auto Ask = [&] {
    Handle.param("upper", Upper, 0.5);
    return sensed() > Limit + Lower + Upper;
  };
  Ask();
  // CHECK: comparisons of {{.*}}: 2
  // CHECK-DAG: parameter 'upper' relation > {{.*}} at [[#@LINE+1]]:16
  if (sensed() > Upper)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'limit' relation > {{.*}} at [[#@LINE+1]]:16
  if (sensed() > Limit)
    Out.publish(std_msgs::Number());
  Lower = 3;
  if (sensed() > Lower)
    Out.publish(std_msgs::Number());
}
