// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A store to one element replaces its value and that of no other element; one
// at an index that is not constant replaces nothing. This holds for locals,
// parts of objects, shared memory and messages.
#include <ros/ros.h>

struct Series {
  double Values[2];
  double data = 0;
};

double Shared[2];

// CHECK: comparisons of {{.*}}: 10
void local(ros::NodeHandle &Handle, ros::Publisher &Out, double V, int I) {
  std_msgs::Number Message;
  double Limits[2];
  Handle.param("replaced", Limits[0], 0.5);
  Handle.param("kept", Limits[1], 0.5);
  Limits[0] = 2;
  if (V < Limits[0])
    Out.publish(Message);
  // CHECK-DAG: parameter 'kept' {{.*}} at [[#@LINE+1]]:9
  if (V < Limits[1])
    Out.publish(Message);
  // Not known: which elements a read at an unknown index may still find.
  // CHECK-DAG: parameter 'replaced' {{.*}} at [[#@LINE+2]]:9
  // CHECK-DAG: parameter 'kept' {{.*}} at [[#@LINE+1]]:9
  if (V < Limits[I])
    Out.publish(Message);
  Limits[I] = 3;
  // CHECK-DAG: parameter 'kept' {{.*}} at [[#@LINE+1]]:9
  if (V < Limits[1])
    Out.publish(Message);
}

void inObject(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  Series Own;
  Handle.param("beside", Own.Values[0], 0.5);
  Own.Values[1] = 2;
  // CHECK-DAG: parameter 'beside' {{.*}} at [[#@LINE+1]]:9
  if (V < Own.Values[0])
    Out.publish(std_msgs::Number());
}

void shared(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  Handle.param("shared 0", Shared[0], 0.5);
  Handle.param("shared 1", Shared[1], 0.5);
  Shared[1] = 2;
  // CHECK-DAG: parameter 'shared 0' {{.*}} at [[#@LINE+1]]:9
  if (V < Shared[0])
    Out.publish(std_msgs::Number());
  if (V < Shared[1])
    Out.publish(std_msgs::Number());
}

struct Node {
  ros::Publisher Out;
  double Odd, Even, Set;
  Series Message;
  void load(ros::NodeHandle &Handle);
  void step(double V);
};

void Node::load(ros::NodeHandle &Handle) {
  Handle.param("odd", Odd, 0.5);
  Handle.param("even", Even, 0.5);
  Handle.param("set", Set, 0.5);
}

void Node::step(double V) {
  // CHECK-DAG: parameter 'odd' {{.*}} at [[#@LINE+1]]:9
  if (V > Odd)
    Message.Values[1] = 1;
  if (V > Even)
    Message.Values[0] = 1;
  Message.Values[0] = 2;
  // CHECK-DAG: parameter 'set' {{.*}} at [[#@LINE+1]]:9
  if (V > Set)
    Message.Values[0] = 3;
  Out.publish(Message);
}

void passed(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  double First, Second;
  Handle.param("first", First, 0.5);
  Handle.param("second", Second, 0.5);
  Series Message;
  // CHECK-DAG: parameter 'first' {{.*}} at [[#@LINE+1]]:9
  if (V > First)
    Message.Values[0] = 1;
  // CHECK-DAG: parameter 'second' {{.*}} at [[#@LINE+1]]:9
  if (V > Second)
    Message.Values[1] = 1;
  Out.publish(Message);
}
