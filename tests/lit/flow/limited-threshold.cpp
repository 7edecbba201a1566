// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A variable that a parameter limits, and that is only compared afterwards, is
// a threshold: the parameter decides what is compared with it.
#include <algorithm>
#include <ros/ros.h>

// CHECK: comparisons of {{.*}}: 10
struct Node {
  double Least, Most, Hard, Narrow, SpeedLimit = 0;
  explicit Node(ros::NodeHandle &Handle) {
    Handle.param("least", Least, 0.5);
    Handle.param("most", Most, 1.0);
    Handle.param("hard", Hard, 1.0);
    Handle.param("narrow", Narrow, 1.0);
  }
  void onLimit(double Given) {
    SpeedLimit = Given;
    // CHECK-DAG: parameter 'hard' relation > as x {{.*}} at [[#@LINE+1]]:20
    if (SpeedLimit > Hard)
      SpeedLimit = Hard;
  }
  void step(ros::Publisher &Out, double Speed, double Range, double Sensed);
};

struct Pair {
  double Range, Limit;
};

void Node::step(ros::Publisher &Out, double Speed, double Range,
                double Sensed) {
  double Stop = Speed * 2;
  // CHECK-DAG: parameter 'least' relation < as x {{.*}} at [[#@LINE+1]]:12
  if (Stop < Least)
    Stop = Least;
  // CHECK-DAG: parameter 'least' relation < as x {{.*}} at [[#@LINE+1]]:13
  if (Range < Stop)
    Out.publish(std_msgs::Number());
  double Look = Speed * 3;
  // CHECK-DAG: parameter 'least' {{.*}} at [[#@LINE+2]]:10
  // CHECK-DAG: parameter 'most' {{.*}} at [[#@LINE+1]]:10
  Look = std::clamp(Look, Least, Most);
  // CHECK-DAG: parameter 'least' relation >= as x {{.*}} at [[#@LINE+2]]:13
  // CHECK-DAG: parameter 'most' relation >= as x {{.*}} at [[#@LINE+1]]:13
  if (Range >= Look)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'hard' relation > as x {{.*}} at [[#@LINE+1]]:13
  if (Speed > SpeedLimit)
    Out.publish(std_msgs::Number());
  Pair P;
  P.Range = Sensed;
  // CHECK-DAG: parameter 'narrow' {{.*}} at [[#@LINE+1]]:13
  P.Limit = std::min(P.Range, Narrow);
  // CHECK-DAG: parameter 'narrow' relation > as x {{.*}} at [[#@LINE+1]]:13
  if (Range > P.Limit)
    Out.publish(std_msgs::Number());
}

void run(ros::NodeHandle &Handle, ros::Publisher &Out, double A, double B,
         double C) {
  Node Of(Handle);
  Of.onLimit(C);
  Of.step(Out, A, B, C);
}
