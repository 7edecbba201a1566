// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A formula of parameters alone is a threshold wherever it goes: it may be
// merged with others, returned and handed on. With something measured in it, it
// belongs to the function that computes it.
#include <ros/ros.h>

struct Node {
  double Accel, Decel, Frequency, Gain;
  explicit Node(ros::NodeHandle &Handle) {
    Handle.param("accel", Accel, 0.5);
    Handle.param("decel", Decel, 0.5);
    Handle.param("frequency", Frequency, 20.0);
    Handle.param("gain", Gain, 1.0);
  }
  double perStep() const { return Accel / Frequency; }
  void step(ros::Publisher &Out, double Now, double Wanted, double Measured);
};

// CHECK: comparisons of {{.*}}: 5
void Node::step(ros::Publisher &Out, double Now, double Wanted,
                double Measured) {
  double Most = Wanted > Now ? Accel / Frequency : Decel / Frequency;
  // CHECK-DAG: derived 'accel' relation > as x / Frequency {{.*}} at [[#@LINE+3]]:20
  // CHECK-DAG: derived 'decel' relation > as x / Frequency {{.*}} at [[#@LINE+2]]:20
  // CHECK-DAG: derived 'frequency' relation > as {{.*}} / x {{.*}} at [[#@LINE+1]]:20
  if (Wanted - Now > Most)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: derived 'accel' relation > as x / Frequency {{.*}} at [[#@LINE+2]]:16
  // CHECK-DAG: derived 'frequency' relation > as Accel / x {{.*}} at [[#@LINE+1]]:16
  if (Measured > perStep())
    Out.publish(std_msgs::Number());
  double Sum = Wanted > Now ? Gain * Measured : Gain + Measured;
  if (Now > Sum)
    Out.publish(std_msgs::Number());
}

void run(ros::NodeHandle &Handle, ros::Publisher &Out, double A, double B,
         double C) {
  Node(Handle).step(Out, A, B, C);
}
