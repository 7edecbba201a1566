// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// In an endless loop the inner branches decide, also those that start the next
// round; an earlier loop that ends does not.
#include <ros/ros.h>

double sensed();

// CHECK: comparisons of {{.*}}: 1
void skips(ros::NodeHandle &Handle, ros::Publisher &Out) {
  double Limit;
  Handle.param("limit", Limit, 0.5);
  while (true) {
    // CHECK-NEXT: 'limit' {{.*}} distance 1 {{.*}} at [[#@LINE+1]]:18
    if (sensed() > Limit)
      continue;
    Out.publish(std_msgs::Number());
  }
}

void waits(ros::NodeHandle &Handle, ros::Publisher &Out) {
  double Ready;
  Handle.param("ready", Ready, 0.5);
  while (sensed() < Ready)
    ;
  while (true)
    Out.publish(std_msgs::Number());
}
