// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// If both operands can hold the value of a parameter, the threshold is the one
// that never holds anything else: a value that was limited before is compared
// with the next limit, and is not a threshold. Two that are both configured are
// both reported; if one parameter is on both sides, the nearer read counts.
#include <ros/ros.h>

class Node {
public:
  explicit Node(ros::NodeHandle &Handle) {
    Handle.param("upper", Upper, 5.0);
    Handle.param("lower", Lower, -5.0);
    Handle.param("floor", Floor, 0.5);
    Handle.param("gain", Gain, 1.0);
    Last = Gain;
  }
  void step(ros::Publisher &Out, double V) {
    // CHECK: comparisons of {{.*}}: 6
    // CHECK-DAG: parameter 'upper' relation > as x {{.*}} at [[#@LINE+1]]:11
    if (V > Upper)
      V = Upper;
    // CHECK-DAG: parameter 'lower' relation < as x {{.*}} at [[#@LINE+1]]:11
    if (V < Lower)
      V = Lower;
    // CHECK-DAG: parameter 'floor' relation > as x {{.*}} at [[#@LINE+1]]:27
    if (__builtin_fabs(V) > Floor)
      Out.publish(std_msgs::Number());
    // CHECK-DAG: parameter 'upper' relation > as x {{.*}} at [[#@LINE+2]]:15
    // CHECK-DAG: parameter 'lower' relation < as x {{.*}} at [[#@LINE+1]]:15
    if (Lower > Upper)
      Out.publish(std_msgs::Number());
    // CHECK-DAG: parameter 'gain' relation != as x {{.*}} at [[#@LINE+1]]:14
    if (Gain != Last)
      Out.publish(std_msgs::Number());
  }

private:
  double Upper, Lower, Floor, Gain, Last;
};

void run(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  Node N(Handle);
  N.step(Out, V);
}
