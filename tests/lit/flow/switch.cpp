// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A switch on a parameter is a flag; a switch on a value computed from one is a
// derived comparison.
#include <ros/ros.h>

enum Mode { Slow, Fast };

void step(ros::NodeHandle &Handle, ros::Publisher &Out) {
  int N;
  Handle.param("n", N, 5);
  // CHECK-DAG: flag 'n' relation flag as x distance 1 {{.*}} at [[#@LINE+1]]:3
  switch (static_cast<Mode>(N)) {
  case Slow:
    break;
  case Fast:
    Out.publish(std_msgs::Number());
  }
  // CHECK-DAG: derived 'n' relation flag as (x rem 4) + 1 distance 1 {{.*}} at [[#@LINE+1]]:3
  switch (N % 4 + 1) {
  case 1:
    Out.publish(std_msgs::Number());
  }
}
