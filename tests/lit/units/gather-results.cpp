// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// GatherResults: only a comparison with a parameter together with an exposed
// predicate makes a result.
#include <ros/ros.h>

int Count;

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  double Compared, Unexposed;
  Handle.param("compared", Compared, 0.5);
  Handle.param("unexposed", Unexposed, 0.5);
  // CHECK: comparisons of {{.*}}: 1
  // CHECK-NEXT: parameter 'compared' {{.*}} at [[#@LINE+1]]:9
  if (V > Compared)
    Out.publish(std_msgs::Number());
  if (V > Unexposed)
    ++Count;
  if (V > 7)
    Out.publish(std_msgs::Number());
}
