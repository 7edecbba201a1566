// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A message that is a member, or that a function gets by reference, shows the
// last write into it; what another function writes before is overwritten, what
// it writes after is not.
#include <ros/ros.h>

struct Node {
  ros::Publisher Out;
  double Cut, Filled, Late, Mine;
  std_msgs::Number Message;
  explicit Node(ros::NodeHandle &Handle);
  void fill(double V);
  void early(double V);
  void late(double V);
  void step(double V);
};

Node::Node(ros::NodeHandle &Handle) {
  Handle.param("cut", Cut, 1.0);
  Handle.param("filled", Filled, 1.0);
  Handle.param("late", Late, 1.0);
  Handle.param("mine", Mine, 1.0);
}

// CHECK: comparisons of {{.*}}: 2
void Node::early(double V) {
  if (V > Filled)
    Message.data = 4;
}

void Node::late(double V) {
  // CHECK-DAG: parameter 'late' {{.*}} at [[#@LINE+1]]:9
  if (V > Late)
    Message.data = 5;
}

static void preset(std_msgs::Number &Message, double V, double Limit) {
  if (V > Limit)
    Message.data = 7;
}

static void set(std_msgs::Number &Message, double V, double Limit) {
  // CHECK-DAG: parameter 'mine' {{.*}} at [[#@LINE+1]]:9
  if (V > Limit)
    Message.data = 6;
}

void Node::step(double V) {
  early(V);
  if (V > Cut)
    Message.data = 3;
  Message.data = 2;
  late(V);
  Out.publish(Message);

  std_msgs::Number Own;
  preset(Own, V, Cut);
  Own.data = 1;
  set(Own, V, Mine);
  Out.publish(Own);
}

int main() {
  ros::NodeHandle Handle;
  Node N(Handle);
  N.step(1);
}
