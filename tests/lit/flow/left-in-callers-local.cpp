// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// What a function writes to a variable of its caller counts as still being there at
// the next call, although that is another activation's variable. This is a limit
// (docs/reference/analysis-limits.md): 'slow' is never compared.
// A comparison with a constant does not count, since the variable may hold
// something else than the parameter.
#include <ros/ros.h>

double sensed();

struct Node {
  double Slow, Near;
  std_msgs::Number Command;
  ros::Publisher Out;

  explicit Node(ros::NodeHandle &Handle) {
    // CHECK: comparisons of {{.*}}: 2
    Handle.param("slow", Slow, 1.0);
    Handle.param("near", Near, 1.0);
  }

  void guard(std_msgs::Number &Twist) {
    if (Twist.data <= 0)
      return;
    // CHECK-DAG: 'slow' relation >= as x {{.*}} at [[#@LINE+1]]:20
    if (Twist.data <= sensed())
      return;
    // CHECK-DAG: 'near' relation < as x {{.*}} at [[#@LINE+1]]:18
    if (sensed() < Near)
      Twist.data = Slow;
  }

  void step() {
    std_msgs::Number Twist = Command;
    guard(Twist);
    Out.publish(Twist);
  }
};

int main() {
  ros::NodeHandle Handle;
  Node It(Handle);
  It.Command.data = sensed();
  It.step();
}
