// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// Mathematical functions and integer operations are kept as expressions, with
// the affine steps around and inside them folded.
#include <ros/ros.h>

#include <cmath>

void numbers(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  double X;
  Handle.param("x", X, 0.5);
  // CHECK-DAG: relation > as pow(x, 3) {{.*}} at [[#@LINE+1]]:9
  if (V > std::pow(X, 3))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: relation > as pow(2, x) {{.*}} at [[#@LINE+1]]:9
  if (V > std::pow(2.0, X))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: relation > as 2 * sqrt(x + 1) - 3 {{.*}} at [[#@LINE+1]]:9
  if (V > 2 * std::sqrt(X + 1) - 3)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: relation > as abs(x) {{.*}} at [[#@LINE+1]]:9
  if (V > std::fabs(X))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: relation > as tan(0.5 * x) {{.*}} at [[#@LINE+1]]:9
  if (V > std::tan(X / 2))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: relation > as exp(-1 * x) {{.*}} at [[#@LINE+1]]:9
  if (V > std::exp(-X))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: relation > as 3 / (x + 1) {{.*}} at [[#@LINE+1]]:9
  if (V > 3 / (X + 1))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: relation > as -(x + 1)^2 + 5 {{.*}} at [[#@LINE+1]]:9
  if (V > 5 - (X + 1) * (X + 1))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: relation > as 0.017453292519943295 * x {{.*}} at [[#@LINE+1]]:9
  if (V > X * M_PI / 180)
    Out.publish(std_msgs::Number());
  // Inverse operations give the parameter again.
  // CHECK-DAG: parameter 'x' relation > as x {{.*}} at [[#@LINE+1]]:9
  if (V > (X + 2) - 2)
    Out.publish(std_msgs::Number());
}

void integers(ros::NodeHandle &Handle, ros::Publisher &Out, int V) {
  int N;
  Handle.param("n", N, 5);
  // CHECK-DAG: relation > as trunc(x / 3) {{.*}} at [[#@LINE+1]]:9
  if (V > N / 3)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: relation > as trunc(x / 3) rem 4 {{.*}} at [[#@LINE+1]]:9
  if (V > N / 3 % 4)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: relation > as (x & 7) + 1 {{.*}} at [[#@LINE+1]]:9
  if (V > (N & 7) + 1)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: relation > as x >> 2 {{.*}} at [[#@LINE+1]]:9
  if (V > (N >> 2))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: relation > as 8 * x {{.*}} at [[#@LINE+1]]:9
  if (V > (N << 3))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: relation > as -1 * x - 1 {{.*}} at [[#@LINE+1]]:9
  if (V > ~N)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: relation > as abs(x) {{.*}} at [[#@LINE+1]]:9
  if (V > std::abs(N))
    Out.publish(std_msgs::Number());
}
