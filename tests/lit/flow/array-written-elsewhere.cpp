// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A local array whose address another function knows: the address of its first
// element is stored.
#include <ros/ros.h>

double *Kept;
void update(double V) { Kept[0] = V; }

// CHECK: comparisons of {{.*}}: 1
void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double Limits[2], Low;
  Handle.param("low", Low, 0.5);
  Kept = Limits;
  Limits[0] = 1;
  Limits[1] = 1;
  update(Low);
  // CHECK: parameter 'low' {{.*}} at [[#@LINE+1]]:13
  if (Value < Limits[0])
    Out.publish(std_msgs::Number());
  if (Value < Limits[1])
    Out.publish(std_msgs::Number());
}

int main() {
  ros::NodeHandle Handle;
  ros::Publisher Out;
  step(Handle, Out, 1);
}
