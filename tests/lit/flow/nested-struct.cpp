// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// Fields of the same class in two objects are distinguished by their paths, and
// a copy of a whole object copies them.
#include <ros/ros.h>

struct Range {
  double Low, High;
};
struct Limits {
  Range Height, Speed;
};

class Node {
public:
  explicit Node(ros::NodeHandle &Handle) {
    Limits L;
    Handle.param("high", L.Height.High, 3.0);
    L.Speed.High = 7;
    Mine = L;
  }
  void step(double Value) {
    // CHECK: comparisons of {{.*}}: 1
    // CHECK: parameter 'high' {{.*}} at [[#@LINE+1]]:15
    if (Value > Mine.Height.High)
      Out.publish(std_msgs::Number());
    if (Value > Mine.Speed.High)
      Out.publish(std_msgs::Number());
  }
  Limits Mine;
  ros::Publisher Out;
};

void run(ros::NodeHandle &Handle) { Node(Handle).step(1); }
