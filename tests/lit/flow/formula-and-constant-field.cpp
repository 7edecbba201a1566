// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A parameter in a formula with other values is a part of what is measured if
// the other side is a member that only holds constants, as if that constant
// stood there. With a member that holds measured values, the formula is the
// threshold.
#include <ros/ros.h>

class Filter {
public:
  explicit Filter(ros::NodeHandle &Handle) {
    Handle.param("size", Size, 10);
    Spread = 0.5;
  }
  void sense(double V) { Seen = V; }
  void step(ros::Publisher &Out, double Total, double V) {
    // CHECK: comparisons of {{.*}}: 1
    // CHECK-NEXT: derived 'size' relation > as {{.*}} at [[#@LINE+1]]:
    if (Seen > Total / Size)
      Out.publish(std_msgs::Number());
    if (__builtin_fabs(V - Total / Size) > Spread)
      Out.publish(std_msgs::Number());
  }

private:
  int Size;
  double Spread, Seen;
};

void run(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  static Filter F(Handle);
  F.sense(V);
  F.step(Out, 2 * V, V);
}
