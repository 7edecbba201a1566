// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A comparison's outcome that a variable carries to a later branch: a local,
// and a member that another method reads.
#include <ros/ros.h>

class Node {
public:
  explicit Node(ros::NodeHandle &Handle) { Handle.param("limit", Limit, 0.5); }
  void sense(double Value) {
    // CHECK: comparisons of {{.*}}: 2
    // CHECK-DAG: 'limit' relation >= {{.*}} in _ZN4Node5senseEd at [[#@LINE+1]]:20
    Enough = Value >= Limit;
  }
  void act(double Value) {
    if (Enough)
      Out.publish(std_msgs::Number());
    // CHECK-DAG: 'limit' relation < {{.*}} in _ZN4Node3actEd at [[#@LINE+1]]:24
    bool Small = Value < Limit;
    Value += 1;
    if (Small && Value > 3)
      Out.publish(std_msgs::Number());
  }

private:
  ros::Publisher Out;
  double Limit;
  bool Enough = false;
};

void run(ros::NodeHandle &Handle) {
  Node N(Handle);
  N.sense(1);
  N.act(2);
}
