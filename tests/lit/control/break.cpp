// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A break decides whether what follows it in the loop is published.
#include <ros/ros.h>

void step(ros::NodeHandle &Handle, ros::Publisher &Out, const double *Values) {
  double Limit;
  Handle.param("limit", Limit, 0.5);
  for (int I = 0; I < 10; ++I) {
    // CHECK: comparisons of {{.*}}: 1
    // CHECK: 'limit' {{.*}} distance 1 {{.*}} at [[#@LINE+1]]:
    if (Values[I] > Limit)
      break;
    Out.publish(std_msgs::Number());
  }
}
