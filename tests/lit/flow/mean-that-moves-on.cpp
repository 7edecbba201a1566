// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A formula in a variable that the program moves on elsewhere is a mean or a
// sum, and no threshold. One that is only computed anew is a threshold.
#include <ros/ros.h>

int Size;
double Slow, Deadline;

void publish() { ros::Publisher().publish(std_msgs::Number()); }

void configure(ros::NodeHandle &Handle) { Handle.param("size", Size, 10); }

void sense(double Total, double Now) {
  double Mean = Total / Size;
  if (Slow == 0)
    Slow = Mean;
  else
    Slow += 0.1 * (Mean - Slow);
  Deadline = Now + Size;
}

void step(double Chance, double Now) {
  // CHECK: comparisons of {{.*}}: 1
  // CHECK-NEXT: derived 'size' relation > as x + Now {{.*}} at [[#@LINE+1]]:
  if (Now > Deadline)
    publish();
  if (Chance < Slow)
    publish();
}
