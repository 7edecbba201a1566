// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A value times its negative is its square, negated; also for integers.
#include <ros/ros.h>

static double Radius;
static int Count;

void run(ros::NodeHandle &Handle, ros::Publisher &Out, double V, int N) {
  Handle.param("radius", Radius, 1.0);
  Handle.param("count", Count, 1);
  // CHECK: comparisons of {{.*}}: 2
  // CHECK-DAG: derived 'radius' relation > as -x^2 {{.*}} at [[#@LINE+1]]:9
  if (V > Radius * -Radius)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: derived 'count' relation > as -x^2 {{.*}} at [[#@LINE+1]]:9
  if (N > Count * -Count)
    Out.publish(std_msgs::Number());
}
