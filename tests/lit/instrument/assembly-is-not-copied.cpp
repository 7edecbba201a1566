// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %s -o %t.o
// RUN: %link -O2 %t.o %t.ros.o -o %t
// RUN: env PARAM_p=0 PARAM_q=5 %t | FileCheck %s
//
// A function whose assembly defines a symbol is not copied for its calls: the
// linker would reject two of them.
// CHECK: report 1 cmp 1 thresh 0
// CHECK: published out 0
// CHECK: report 0 cmp 2 thresh 5
#include <ros/ros.h>

static ros::Publisher Out;

__attribute__((noinline)) void above(double V, double Limit) {
  asm volatile("my_probe_point: nop");
  if (V > Limit)
    Out.publish(std_msgs::Number());
}

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  Out = Handle.advertise<std_msgs::Number>("out", 1);
  double P, Q;
  Handle.param("p", P, 1.0);
  Handle.param("q", Q, 1.0);
  above(Argc, P);
  above(Argc + 1, Q);
}
