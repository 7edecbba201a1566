// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// Masks and shifts in the program itself are not bit fields: a mask that truncates is
// arithmetic, and a number that is packed together with another one and compared with
// it is lost. A truth value that is combined with another by `|=` is not a bit field.
#include <ros/ros.h>

void step(ros::NodeHandle &Handle, ros::Publisher &Out, int N) {
  int Mask, Shifted, Packed, Plain;
  Handle.param("mask", Mask, 1);
  Handle.param("shifted", Shifted, 1);
  Handle.param("packed", Packed, 1);
  Handle.param("plain", Plain, 1);
  // CHECK: comparisons of {{.*}}: 3
  // CHECK-DAG: derived 'mask' relation > as x & 12 {{.*}} at [[#@LINE+1]]:9
  if (N > (Mask & 12))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: derived 'shifted' relation > as 16 * x {{.*}} at [[#@LINE+1]]:9
  if (N > (Shifted << 4))
    Out.publish(std_msgs::Number());
  if (N > ((Packed & 15) | (N << 4)))
    Out.publish(std_msgs::Number());
  bool Large = false;
  // CHECK-DAG: parameter 'plain' relation > as x {{.*}} at [[#@LINE+1]]:14
  Large |= N > Plain;
  if (Large)
    Out.publish(std_msgs::Number());
}
