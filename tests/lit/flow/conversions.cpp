// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A conversion that can change the value is part of the arithmetic; one that
// only changes the type is not.
#include <ros/ros.h>

unsigned char Byte;

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double V, long W) {
  double X;
  int N;
  bool B;
  Handle.param("x", X, 0.5);
  Handle.param("n", N, 5);
  Handle.param("b", B, false);
  // CHECK-DAG: derived 'x' relation > as trunc(x) {{.*}} at [[#@LINE+1]]:9
  if (W > static_cast<int>(X))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'x' relation > as x {{.*}} at [[#@LINE+1]]:9
  if (V > static_cast<float>(X))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'n' relation > as x {{.*}} at [[#@LINE+1]]:9
  if (V > N)
    Out.publish(std_msgs::Number());
  // Back and forth: what was an int fits into one.
  // CHECK-DAG: parameter 'n' relation > as x {{.*}} at [[#@LINE+1]]:9
  if (W > static_cast<int>(static_cast<long>(N)))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'n' relation > as x {{.*}} at [[#@LINE+1]]:9
  if (W > static_cast<int>(static_cast<double>(N)))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'n' relation > as x {{.*}} at [[#@LINE+1]]:9
  if (W > static_cast<signed char>(N))
    Out.publish(std_msgs::Number());
  Byte = N;
  // CHECK-DAG: parameter 'n' relation > as x {{.*}} at [[#@LINE+1]]:9
  if (W > Byte)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'b' relation > as x {{.*}} at [[#@LINE+1]]:9
  if (W > static_cast<int>(B))
    Out.publish(std_msgs::Number());
}
