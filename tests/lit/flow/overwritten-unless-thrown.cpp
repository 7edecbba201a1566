// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A member that is overwritten behind a call keeps its value if the call
// throws: the handler sees it and, if that is in a caller, everybody. If
// nothing is thrown, or the handler overwrites it too, nobody sees it.
#include <ros/ros.h>

struct Node {
  ros::Publisher Out;
  double Left, Below, Handled, Kept, Sure, Both, Local;
  double A = 0, B = 0, C = 0, D = 0, E = 0, F = 0, G = 0;
  explicit Node(ros::NodeHandle &Handle);
  void send(double Value);
  void sendC() { send(C); }
  void check(double V) {
    if (V < 0)
      throw 1;
  }
  void checkDeep(double V) { check(V); }
  void look(double V) { send(V); }
  void left(double V);
  void below(double V);
  void handled(double V);
  void kept(double V);
  void sure(double V);
  void both(double V);
  void local(double V);
};

Node::Node(ros::NodeHandle &Handle) {
  Handle.param("left", Left, 1.0);
  Handle.param("below", Below, 1.0);
  Handle.param("handled", Handled, 1.0);
  Handle.param("kept", Kept, 1.0);
  Handle.param("sure", Sure, 1.0);
  Handle.param("both", Both, 1.0);
  Handle.param("local", Local, 1.0);
}

void Node::send(double Value) {
  std_msgs::Number Message;
  Message.data = Value;
  Out.publish(Message);
}

// CHECK: comparisons of {{.*}}: 4
void Node::left(double V) {
  // CHECK-DAG: parameter 'left' {{.*}} at [[#@LINE+1]]:9
  A = V > Left ? 1 : 0;
  check(V);
  A = 0;
}

void Node::below(double V) {
  // CHECK-DAG: parameter 'below' {{.*}} at [[#@LINE+1]]:9
  B = V > Below ? 1 : 0;
  try {
    checkDeep(V);
  } catch (const char *) {
    B = 0;
  }
  B = 0;
}

void Node::handled(double V) {
  // CHECK-DAG: parameter 'handled' {{.*}} at [[#@LINE+1]]:9
  C = V > Handled ? 1 : 0;
  try {
    check(V);
  } catch (int) {
    sendC();
  }
  C = 0;
}

void Node::kept(double V) {
  // CHECK-DAG: parameter 'kept' {{.*}} at [[#@LINE+1]]:9
  D = V > Kept ? 1 : 0;
  try {
    check(V);
  } catch (int) {
    return;
  }
  D = 0;
}

void Node::sure(double V) {
  E = V > Sure ? 1 : 0;
  look(V);
  E = 0;
}

void Node::both(double V) {
  F = V > Both ? 1 : 0;
  try {
    check(V);
  } catch (int) {
    F = 1;
    return;
  }
  F = 0;
}

void Node::local(double V) {
  G = V > Local ? 1 : 0;
  try {
    if (V < 1)
      throw 2;
  } catch (int) {
  }
  G = 0;
}

int main() {
  ros::NodeHandle Handle;
  Node N(Handle);
  try {
    N.left(1);
    N.below(1);
    N.handled(1);
    N.kept(1);
    N.sure(1);
    N.both(1);
    N.local(1);
  } catch (int) {
  }
  N.send(N.A + N.B + N.D + N.E + N.F + N.G);
}
