// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// `isunordered(a, b)` asks whether the two are numbers, not how they compare, so
// it is not a comparison with a threshold. `<=` is reported as `<=` in every form.
#include <ros/ros.h>

void step(ros::Publisher &Out, double Limit, double V, int I, unsigned N) {
  // CHECK: threshold predicate comparisons of {{.*}}: 1
  // CHECK-NEXT: parameter 'limit' relation <= as x distance 1 {{.*}} at [[#@LINE+1]]:9
  if (V <= Limit)
    Out.publish(std_msgs::Number());
  if (__builtin_isunordered(V, Limit))
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: comparisons with constants: 4
  if (__builtin_isunordered(V, 0.75))
    Out.publish(std_msgs::Number());
  if (!__builtin_isunordered(0.625, V))
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: constant '0.5' relation <= as x distance 1 {{.*}} at [[#@LINE+1]]:9
  if (V <= 0.5)
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: constant '0.25' relation <= as x distance 1 {{.*}} at [[#@LINE+1]]:12
  if (0.25 >= V)
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: constant '7' relation <= as x distance 1 {{.*}} at [[#@LINE+1]]:9
  if (I <= 7)
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: constant '9' relation <= as x distance 1 {{.*}} at [[#@LINE+1]]:9
  if (N <= 9)
    Out.publish(std_msgs::Number());
}

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  double Limit;
  Handle.param("limit", Limit, 2.0);
  step(Out, Limit, Argc * 0.5, Argc, Argc);
}
