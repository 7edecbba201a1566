// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A member that is recomputed directly after the read has only the new value
// elsewhere. If that depends on a condition, or a method called in between
// reads it, it can have either value.
#include <ros/ros.h>

#include <cmath>

struct Side {
  double Limit;
};

struct Node {
  ros::Publisher Out;
  double Angle, Maybe, Between;
  Side *Left, *Right;
  Node(ros::NodeHandle &Handle, bool Degrees);
  void check(double V);
  void step(double V);
};

Node::Node(ros::NodeHandle &Handle, bool Degrees) {
  Handle.param("angle", Angle, 45.0);
  Handle.param("maybe", Maybe, 45.0);
  Handle.param("between", Between, 45.0);
  Handle.param("left", Left->Limit, 1.0);
  Right->Limit = 3;
  // CHECK-DAG: parameter 'angle' relation < as x {{.*}} at [[#@LINE+1]]:13
  if (Angle > 360)
    Out.publish(std_msgs::Number());
  Angle *= M_PI / 180;
  if (Degrees)
    Maybe *= M_PI / 180;
  check(7);
  Between /= 2;
}

void Node::check(double V) {
  // CHECK-DAG: parameter 'between' relation > as x {{.*}} at [[#@LINE+1]]:9
  if (V > Between)
    Out.publish(std_msgs::Number());
}

void Node::step(double V) {
  // CHECK-DAG: derived 'angle' relation > as 0.017453292519943295 * x {{.*}} at [[#@LINE+1]]:9
  if (V > Angle)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'maybe' relation > as x {{.*}} at [[#@LINE+1]]:9
  if (V > Maybe)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'left' relation > as x {{.*}} at [[#@LINE+1]]:9
  if (V > Left->Limit)
    Out.publish(std_msgs::Number());
}

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  Node N(Handle, Argc > 1);
  N.step(1);
}
