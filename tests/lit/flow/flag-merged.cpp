// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A flag that is merged with other values before it decides has a place where
// each of its values is read, also if several of them are of one parameter.
#include <ros/ros.h>

bool chance();

static bool Near, Far;
static double Mode;

void run(ros::NodeHandle &Handle, ros::Publisher &Out) {
  Handle.param("use", Near, true);
  Far = Near;
  Handle.param("mode", Mode, 1.0);
  // CHECK: comparisons of {{.*}}: 4
  // CHECK-DAG: flag 'use' relation flag as x distance 1 {{.*}} at [[#@LINE+2]]:18
  // CHECK-DAG: flag 'use' relation flag as x distance 1 {{.*}} at [[#@LINE+1]]:25
  if (chance() ? Near : Far)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: derived 'mode' relation flag as trunc(x) distance 1 {{.*}} at [[#@LINE+2]]:39
  // CHECK-DAG: derived 'mode' relation flag as trunc(0.1 * x) distance 1 {{.*}} at [[#@LINE+1]]:51
  switch (static_cast<int>(chance() ? Mode : Mode / 10)) {
  case 2:
    Out.publish(std_msgs::Number());
  }
}
