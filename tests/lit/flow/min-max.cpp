// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// The smaller or larger of a parameter and a constant is an expression, whether
// the library or the program chooses.
#include <ros/ros.h>

#include <algorithm>
#include <cmath>

struct Node {
  double X;
  int N;
  void step(ros::NodeHandle &Handle, ros::Publisher &Out, double V, int W);
};

void Node::step(ros::NodeHandle &Handle, ros::Publisher &Out, double V, int W) {
  Handle.param("x", X, 0.5);
  Handle.param("n", N, 5);
  // CHECK-DAG: derived 'x' relation > as min(x, 10) {{.*}} at [[#@LINE+1]]:9
  if (V > std::min(X, 10.0))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: derived 'x' relation > as max(x, 10) {{.*}} at [[#@LINE+1]]:9
  if (V > std::max(10.0, X))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: derived 'x' relation < as 2 * min(max(x, 1), 2) {{.*}} at [[#@LINE+1]]:9
  if (V < 2 * std::clamp(X, 1.0, 2.0))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: derived 'x' relation > as max(x, 7) {{.*}} at [[#@LINE+2]]:9
  double Most = X < 7 ? 7 : X;
  if (V > Most)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: derived 'n' relation > as min(x, 7) {{.*}} at [[#@LINE+4]]:9
  int Least = N;
  if (Least > 7)
    Least = 7;
  if (W > Least)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: derived 'x' relation > as max(x, 4) {{.*}} at [[#@LINE+1]]:9
  if (V > std::fmax(X, 4.0))
    Out.publish(std_msgs::Number());
  // With a constant other than the compared one there is no limit: the value is merged.
  // CHECK-DAG: parameter 'n' relation < as x {{.*}} at [[#@LINE+2]]:9
  int Other = N > 7 ? 3 : N;
  if (W < Other)
    Out.publish(std_msgs::Number());
}
