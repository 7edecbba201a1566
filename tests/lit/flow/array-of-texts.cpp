// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// Strings in an array are distinguished like numbers.
#include <ros/ros.h>

std::string Names[2];

struct Node {
  std::string Own[2];
  explicit Node(ros::NodeHandle &Handle);
  void step(ros::Publisher &Out, const std::string &V);
};

Node::Node(ros::NodeHandle &Handle) {
  Handle.param<std::string>("names 0", Names[0], "a");
  Handle.param<std::string>("names 1", Names[1], "b");
  Handle.param<std::string>("own 1", Own[1], "c");
}

// CHECK: comparisons of {{.*}}: 3
void Node::step(ros::Publisher &Out, const std::string &V) {
  // CHECK-DAG: parameter 'names 0' {{.*}} at [[#@LINE+1]]:9
  if (V == Names[0])
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'names 1' {{.*}} at [[#@LINE+1]]:9
  if (V == Names[1])
    Out.publish(std_msgs::Number());
  if (V == Own[0])
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'own 1' {{.*}} at [[#@LINE+1]]:9
  if (V == Own[1])
    Out.publish(std_msgs::Number());
}

int main(int, char **Arguments) {
  ros::NodeHandle Handle;
  ros::Publisher Out;
  Node N(Handle);
  N.step(Out, Arguments[0]);
}
