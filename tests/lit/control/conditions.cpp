// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// The operands of one condition are counted together and have the same
// distance: in a loop, in a variable and in an if, also if there are cleanups.
#include <ros/ros.h>

double A, B;

void load(ros::NodeHandle &Handle) {
  Handle.param("a", A, 1.0);
  Handle.param("b", B, 1.0);
}

void mixed(ros::Publisher &Out, double V, double W) {
  // CHECK-DAG: 'a' {{.*}} distance 1 others 1 in {{.*}} at [[#@LINE+2]]:9
  // CHECK-DAG: 'b' {{.*}} distance 2 others 1 in {{.*}} at [[#@LINE+1]]:19
  if (V > A || (V < B && W > 3))
    Out.publish(std_msgs::Number());
}

void loop(ros::Publisher &Out, double V) {
  // CHECK-DAG: 'a' {{.*}} distance 2 others 1 in {{.*}} at [[#@LINE+2]]:12
  // CHECK-DAG: 'b' {{.*}} distance 1 others 1 in {{.*}} at [[#@LINE+1]]:21
  while (V > A && V < B) {
    Out.publish(std_msgs::Number());
    V += 1;
  }
}

void variable(ros::Publisher &Out, double V) {
  // CHECK-DAG: 'a' {{.*}} distance 2 others 1 in {{.*}} at [[#@LINE+2]]:19
  // CHECK-DAG: 'b' {{.*}} distance 1 others 1 in {{.*}} at [[#@LINE+1]]:28
  bool Inside = V > A && V < B;
  if (Inside)
    Out.publish(std_msgs::Number());
}

void cleanup(ros::Publisher &Out, double V) {
  {
    std::string Text("to clean up");
    // CHECK-DAG: 'a' {{.*}} distance 1 others 0 in {{.*}} at [[#@LINE+1]]:11
    if (V > A)
      return;
  }
  Out.publish(std_msgs::Number());
}
