// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A predicate decides a value that decides another predicate, through a member
// that one method writes and another reads.
#include <ros/ros.h>

class Node {
public:
  explicit Node(ros::NodeHandle &Handle) { Handle.param("limit", Limit, 0.5); }
  void sense(double Value) {
    // CHECK: comparisons of {{.*}}: 1
    // CHECK: 'limit' {{.*}} in _ZN4Node5senseEd at [[#@LINE+1]]:
    if (Value > Limit)
      State = 2;
    else
      State = 1;
  }
  void act() {
    if (State == 2)
      Out.publish(std_msgs::Number());
  }

private:
  ros::Publisher Out;
  double Limit;
  int State = 0;
};

void run(ros::NodeHandle &Handle) {
  Node N(Handle);
  N.sense(1);
  N.act();
}
