// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A local variable that a lambda captures is no other variable: what its own
// function writes is seen by what follows, not by what came before, and what it
// replaces is gone. What the lambda writes may be seen anywhere.
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
