// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// An exposing statement shows its message, not the publisher that it is called
// on: how the publisher was made decides nothing of what is sent.
#include <ros/ros.h>

// CHECK: comparisons of {{.*}}: 1
// CHECK-NEXT: parameter 'shown' relation > as x distance 2

class Node {
public:
  Node(ros::NodeHandle &Handle, const ros::Publisher &Spare) {
    double Load = 0, Full = 0;
    Handle.getParam("load", Load);
    Handle.getParam("full", Full);
    if (Load > Full)
      Out = Spare;
  }

  void step(ros::NodeHandle &Handle, double Value) {
    double Shown = 0;
    Handle.getParam("shown", Shown);
    std_msgs::Number Message;
    if (Value > Shown)
      Message.data = Value;
    Out.publish(Message);
  }

private:
  ros::Publisher Out;
};

void run(ros::NodeHandle &Handle, const ros::Publisher &Spare, double Value) {
  Node It(Handle, Spare);
  It.step(Handle, Value);
}
