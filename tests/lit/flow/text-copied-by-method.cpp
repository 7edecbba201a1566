// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// The headers of two poses are assigned by the same operator. The frame that
// one assignment copies does not arrive at the other.
#include <ros/ros.h>

struct Header {
  std::string Frame;
};
struct Pose {
  Header Head;
};

struct Node {
  std::string Base, Map;
  explicit Node(ros::NodeHandle &Handle) {
    Handle.param("base", Base, std::string("base"));
    Handle.param("map", Map, std::string("map"));
  }
  void step(ros::Publisher &Out, const std::string &Given);
};

// CHECK: comparisons of {{.*}}: 2
void Node::step(ros::Publisher &Out, const std::string &Given) {
  Pose Robot, Goal, Kept, Wanted;
  Robot.Head.Frame = Base;
  Goal.Head.Frame = Map;
  Kept.Head = Robot.Head;
  Wanted.Head = Goal.Head;
  // CHECK-DAG: parameter 'base' relation == {{.*}} at [[#@LINE+1]]:23
  if (Kept.Head.Frame == Given)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'map' relation == {{.*}} at [[#@LINE+1]]:25
  if (Wanted.Head.Frame == Given)
    Out.publish(std_msgs::Number());
}

int main() {
  ros::NodeHandle Handle;
  Node N(Handle);
  ros::Publisher Out;
  N.step(Out, "given");
}
