// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A member that param() fills, compared in another method.
#include <ros/ros.h>

class Node {
public:
  explicit Node(ros::NodeHandle &Handle) {
    Handle.param("limit", Limit, 0.5);
    Out = Handle.advertise<std_msgs::Number>("out", 1);
  }
  void step(double Value) {
    std_msgs::Number Message;
    // CHECK: comparisons of {{.*}}: 1
    // CHECK: parameter 'limit' relation > as x distance 1 others 0 in _ZN4Node4stepEd at [[#@LINE+1]]:15
    if (Value > Limit)
      Out.publish(Message);
  }

private:
  ros::Publisher Out;
  double Limit;
};

int main() {
  ros::NodeHandle Handle;
  Node N(Handle);
  N.step(1);
}
