// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A predicate decides where a message is seen: by a stored pointer to the
// publisher, by its index, by an argument, and by a result.
// CHECK: comparisons of {{.*}}: 4
#include <ros/ros.h>

struct Chooser {
  ros::Publisher Left, Right, All[2];
  ros::Publisher *Stored = &Left;
  double Kept = 0, Index = 0, Handed = 0, Returned = 0;

  void choose(double Value) {
    // CHECK-DAG: parameter 'kept' relation > as x distance 3 {{.*}} at [[#@LINE+1]]:15
    if (Value > Kept)
      Stored = &Right;
  }
  void send(ros::Publisher &Out) { Out.publish(std_msgs::Number()); }
  ros::Publisher &chosen(double Value) {
    // CHECK-DAG: parameter 'returned' relation > as x distance 4 {{.*}} at [[#@LINE+1]]:18
    return Value > Returned ? Left : Right;
  }
  void step(double Value) {
    Stored->publish(std_msgs::Number());
    // CHECK-DAG: parameter 'index' relation > as x distance 3 {{.*}} at [[#@LINE+1]]:15
    All[Value > Index ? 0 : 1].publish(std_msgs::Number());
    // CHECK-DAG: parameter 'handed' relation > as x distance 2 {{.*}} at [[#@LINE+1]]:16
    send(Value > Handed ? Left : Right);
    chosen(Value).publish(std_msgs::Number());
  }
};

int main(int Count, char **) {
  ros::NodeHandle Handle;
  Chooser C;
  Handle.param("kept", C.Kept, 1.0);
  Handle.param("index", C.Index, 2.0);
  Handle.param("handed", C.Handed, 3.0);
  Handle.param("returned", C.Returned, 4.0);
  C.choose(Count);
  C.step(Count);
}
