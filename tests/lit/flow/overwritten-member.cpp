// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// What a comparison puts into a member no longer counts if the member is
// overwritten on every path to the return; it counts if one path does not
// overwrite it, or if the value is published before.
#include <ros/ros.h>

void show(double Value);

struct Node {
  ros::Publisher Out;
  double Cut, OneWay, Before, Elsewhere, Left;
  double Command = 0, Maybe = 0, Early = 0, Other = 0, Last = 0;
  explicit Node(ros::NodeHandle &Handle);
  void send(double Value);
  void step(double V, bool Odd, Node &Second);
};

Node::Node(ros::NodeHandle &Handle) {
  Handle.param("cut", Cut, 1.0);
  Handle.param("one_way", OneWay, 1.0);
  Handle.param("before", Before, 1.0);
  Handle.param("elsewhere", Elsewhere, 1.0);
  Handle.param("left", Left, 1.0);
}

void Node::send(double Value) {
  std_msgs::Number Message;
  Message.data = Value;
  Out.publish(Message);
}

// CHECK: comparisons of {{.*}}: 4
void Node::step(double V, bool Odd, Node &Second) {
  Command = V > Cut ? 1 : 0;
  show(Command);
  Command = 0;
  send(Command);

  // CHECK-DAG: parameter 'one_way' {{.*}} at [[#@LINE+1]]:13
  Maybe = V > OneWay ? 1 : 0;
  if (Odd)
    Maybe = 0;

  // CHECK-DAG: parameter 'before' {{.*}} at [[#@LINE+1]]:13
  Early = V > Before ? 1 : 0;
  send(Early);
  Early = 0;

  // A member of another object is another variable.
  // CHECK-DAG: parameter 'elsewhere' {{.*}} at [[#@LINE+1]]:13
  Other = V > Elsewhere ? 1 : 0;
  Second.Other = 0;

  // CHECK-DAG: parameter 'left' {{.*}} at [[#@LINE+1]]:9
  if (V > Left) {
    Last = 5;
    throw 1;
  }
  Last = 6;
}

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  Node N(Handle), M(Handle);
  N.step(1, Argc > 1, M);
  N.send(N.Command + N.Maybe + N.Other + N.Last);
}
