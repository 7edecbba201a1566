// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A flag that is an argument and is merged with another value has no place of
// its own: its place is the branch.
#include <ros/ros.h>

static void act(ros::Publisher &Out, int Mode, bool Odd) {
  // CHECK: comparisons of {{.*}}: 1
  // CHECK: flag 'mode' relation flag {{.*}} distance 1 {{.*}} at [[#@LINE+1]]:3
  switch (Odd ? Mode : 2) {
  case 0:
    Out.publish(std_msgs::Number());
  }
}

void step(ros::NodeHandle &Handle, ros::Publisher &Out, bool Odd) {
  int Mode;
  Handle.param("mode", Mode, 1);
  act(Out, Mode, Odd);
}
