// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// The square of a member, and of the target of a reference, whatever that is:
// the variable is read twice at one address.
#include <ros/ros.h>

class Node {
public:
  explicit Node(ros::NodeHandle &Handle) {
    Handle.param("radius", Radius, 1.0);
    Handle.param("side", Side, 1.0);
  }
  void step(double V, double W) {
    // CHECK: comparisons of {{.*}}: 2
    // CHECK-DAG: derived 'radius' relation < as x^2 {{.*}} at [[#@LINE+1]]:11
    if (V < Radius * Radius)
      Out.publish(std_msgs::Number());
    above(V, Side);
    above(V, W);
  }
  void above(double V, double &Length) {
    // CHECK-DAG: derived 'side' relation > as x^2 {{.*}} at [[#@LINE+1]]:11
    if (V > Length * Length)
      Out.publish(std_msgs::Number());
  }

private:
  double Radius, Side;
  ros::Publisher Out;
};

void run(ros::NodeHandle &Handle) {
  Node N(Handle);
  N.step(1, 2);
}
