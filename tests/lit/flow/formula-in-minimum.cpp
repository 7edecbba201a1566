// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// The smallest of several computed values is no threshold: it may be any of
// them. A parameter that is only limited still is one.
#include <algorithm>
#include <ros/ros.h>

static double Height, Low, Limit;

// CHECK: comparisons of {{.*}}: 4
void clip(ros::Publisher &Out, double X, double Z, double Slope) {
  double T = 1;
  // CHECK-DAG: parameter 'height' relation > {{.*}} at [[#@LINE+1]]:9
  if (Z > Height)
    // CHECK-DAG: derived 'height' relation > as (x - Z) / Slope {{.*}} at [[#@LINE+1]]:23
    T = std::max(0.0, std::min(T, (Height - Z) / Slope));
  if (X < 0)
    T = std::min(T, -X / Slope);
  if (T * Slope > 3)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'limit' relation < as x {{.*}} at [[#@LINE+2]]:11
  // CHECK-DAG: derived 'limit' relation > as min(x, 5) {{.*}} at [[#@LINE+1]]:9
  if (X > std::min(Limit, 5.0))
    Out.publish(std_msgs::Number());
}

void run(ros::NodeHandle &Handle, ros::Publisher &Out) {
  Handle.param("height", Height, 1.0);
  Handle.param("limit", Limit, 1.0);
  clip(Out, Low, Low, 2.0);
}
