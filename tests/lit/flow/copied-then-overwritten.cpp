// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A value that is copied before it is overwritten survives in the copy; one
// that is overwritten before the copy does not.
// CHECK: comparisons of {{.*}}: 1
// CHECK-NEXT: parameter 'limit' relation > as x
#include <ros/ros.h>

struct Settings {
  double Limit, Other, More;
};

struct Node {
  ros::NodeHandle Handle;
  ros::Publisher Out;
  Settings Now, Saved;
  double Value;

  void load() {
    Handle.getParam("limit", Now.Limit);
    Saved = Now;
    Now.Limit = 0;
  }
  void check() {
    if (Value > Saved.Limit)
      Out.publish(std_msgs::Number());
    if (Value < Now.Limit)
      Out.publish(std_msgs::Number());
  }
};

void run(Node &It) {
  It.load();
  It.check();
}
