// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A member that getParam() fills and that had another value before.
#include <ros/ros.h>

class Node {
public:
  void load(ros::NodeHandle &Handle) { Handle.getParam("most", Most); }
  void step(int Value) {
    std_msgs::Number Message;
    // CHECK: comparisons of {{.*}}: 1
    // CHECK: parameter 'most' relation <= as x distance 1 others 0 in {{.*}} at [[#@LINE+1]]:15
    if (Value <= Most)
      Out.publish(Message);
  }

private:
  ros::Publisher Out;
  int Most = 3;
};

int main() {
  ros::NodeHandle Handle;
  Node N;
  N.load(Handle);
  N.step(1);
}
