// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// Bit fields share their byte: each is followed through the masks and shifts
// that write and read it, and is not confused with its neighbour.
#include <ros/ros.h>

struct Options {
  unsigned Echo : 1;
  int Level : 3;
  unsigned Unused : 4;
};

class Node {
public:
  explicit Node(ros::NodeHandle &Handle) {
    bool Echo;
    int Level, Unused;
    Handle.param("echo", Echo, true);
    Handle.param("level", Level, 2);
    Handle.param("unused", Unused, 2);
    O.Echo = Echo;
    O.Level = Level;
    O.Unused = Unused;
  }
  void step(ros::Publisher &Out, int N) {
    // CHECK: comparisons of {{.*}}: 2
    // CHECK-DAG: flag 'echo' relation flag {{.*}} at [[#@LINE+1]]:9
    if (O.Echo)
      Out.publish(std_msgs::Number());
    // CHECK-DAG: 'level' relation > as {{.*}} at [[#@LINE+1]]:11
    if (N > O.Level)
      Out.publish(std_msgs::Number());
  }

private:
  Options O = {};
};

void run(ros::NodeHandle &Handle, ros::Publisher &Out, int Number) {
  Node N(Handle);
  N.step(Out, Number);
}
