// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// Elements of an array at constant indices are variables of their own: in
// globals, members and locals, in rows, in arrays of objects, in a std::array,
// and if a function gets the array.
#include <array>
#include <ros/ros.h>

struct Range {
  double Low, High;
};

double Limits[2];
std::array<double, 3> Library;
Range Ranges[2];

static void set(double *To, double Low, double High) {
  To[0] = Low;
  To[1] = High;
}

struct Node {
  double Rows[2][2];
  std::array<double, 2> Pair;
  Range Own[2];
  double Handed[2];
  explicit Node(ros::NodeHandle &Handle);
  void step(ros::Publisher &Out, double V);
};

Node::Node(ros::NodeHandle &Handle) {
  double Low, High;
  Handle.param("limits 0", Limits[0], 0.5);
  Handle.param("limits 1", Limits[1], 0.5);
  Handle.param("library 0", Library[0], 0.5);
  Handle.param("library 2", Library[2], 0.5);
  Handle.param("ranges 0", Ranges[0].High, 0.5);
  Handle.param("ranges 1", Ranges[1].High, 0.5);
  Handle.param("rows 0 1", Rows[0][1], 0.5);
  Handle.param("rows 1 0", Rows[1][0], 0.5);
  Handle.param("pair 1", Pair[1], 0.5);
  Handle.param("own 0", Own[0].Low, 0.5);
  Handle.param("own 1", Own[1].High, 0.5);
  Handle.param("handed 0", Low, 0.5);
  Handle.param("handed 1", High, 0.5);
  set(Handed, Low, High);
}

// CHECK: comparisons of {{.*}}: 13
void Node::step(ros::Publisher &Out, double V) {
  std_msgs::Number Message;
  // CHECK-DAG: parameter 'limits 0' {{.*}} at [[#@LINE+1]]:9
  if (V < Limits[0])
    Out.publish(Message);
  // CHECK-DAG: parameter 'limits 1' {{.*}} at [[#@LINE+1]]:9
  if (V < Limits[1])
    Out.publish(Message);
  // CHECK-DAG: parameter 'library 0' {{.*}} at [[#@LINE+1]]:9
  if (V < Library[0])
    Out.publish(Message);
  if (V < Library[1])
    Out.publish(Message);
  // CHECK-DAG: parameter 'library 2' {{.*}} at [[#@LINE+1]]:9
  if (V < Library[2])
    Out.publish(Message);
  // CHECK-DAG: parameter 'ranges 0' {{.*}} at [[#@LINE+1]]:9
  if (V < Ranges[0].High)
    Out.publish(Message);
  // CHECK-DAG: parameter 'ranges 1' {{.*}} at [[#@LINE+1]]:9
  if (V < Ranges[1].High)
    Out.publish(Message);
  if (V < Ranges[1].Low)
    Out.publish(Message);
  if (V < Rows[0][0])
    Out.publish(Message);
  // CHECK-DAG: parameter 'rows 0 1' {{.*}} at [[#@LINE+1]]:9
  if (V < Rows[0][1])
    Out.publish(Message);
  // CHECK-DAG: parameter 'rows 1 0' {{.*}} at [[#@LINE+1]]:9
  if (V < Rows[1][0])
    Out.publish(Message);
  if (V < Pair[0])
    Out.publish(Message);
  // CHECK-DAG: parameter 'pair 1' {{.*}} at [[#@LINE+1]]:9
  if (V < Pair[1])
    Out.publish(Message);
  // CHECK-DAG: parameter 'own 0' {{.*}} at [[#@LINE+1]]:9
  if (V < Own[0].Low)
    Out.publish(Message);
  if (V < Own[1].Low)
    Out.publish(Message);
  // CHECK-DAG: parameter 'own 1' {{.*}} at [[#@LINE+1]]:9
  if (V < Own[1].High)
    Out.publish(Message);
  // CHECK-DAG: parameter 'handed 0' {{.*}} at [[#@LINE+1]]:9
  if (V < Handed[0])
    Out.publish(Message);
  // CHECK-DAG: parameter 'handed 1' {{.*}} at [[#@LINE+1]]:9
  if (V < Handed[1])
    Out.publish(Message);
}

int main() {
  ros::NodeHandle Handle;
  ros::Publisher Out;
  Node N(Handle);
  N.step(Out, 1);
}
