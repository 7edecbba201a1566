// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// Text is compared by operators and methods of std::string, and is followed
// through copies, members, locals and references.
#include <ros/ros.h>

struct Node {
  std::string Mode, Copy, Unread;
  explicit Node(ros::NodeHandle &Handle) {
    Handle.param("mode", Mode, std::string("slow"));
    Copy = Mode;
  }
  void step(ros::Publisher &Out, const std::string &Given);
};

static bool isFast(const std::string &Text) {
  // CHECK-DAG: parameter 'mode' relation == {{.*}} at [[#@LINE+1]]:15
  return Text == "fast";
}

void Node::step(ros::Publisher &Out, const std::string &Given) {
  // CHECK-DAG: parameter 'mode' relation == {{.*}} at [[#@LINE+1]]:12
  if (Mode == "fast")
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'mode' relation == {{.*}} at [[#@LINE+1]]:14
  if ("fast" == Copy)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'mode' relation != {{.*}} at [[#@LINE+1]]:13
  if (Given != Mode)
    Out.publish(std_msgs::Number());
  std::string Local = Copy;
  // CHECK-DAG: parameter 'mode' relation == {{.*}} at [[#@LINE+1]]:29
  if (Local.compare("fast") == 0)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'mode' relation == {{.*}} at [[#@LINE+1]]:14
  if (!Local.empty())
    Out.publish(std_msgs::Number());
  if (isFast(Mode))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'mode' relation < {{.*}} at [[#@LINE+1]]:13
  if (Given < Mode)
    Out.publish(std_msgs::Number());
  // CHECK-NOT: 'mode' {{.*}} at [[#@LINE+1]]:
  if (Unread == Given)
    Out.publish(std_msgs::Number());
}

int main() {
  ros::NodeHandle Handle;
  Node N(Handle);
  ros::Publisher Out;
  N.step(Out, "given");
}
