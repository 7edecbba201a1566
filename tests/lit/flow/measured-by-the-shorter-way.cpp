// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A parameter on both sides is the threshold where the other side can be
// something else, even if its path there is longer.
#include <ros/ros.h>

double sensed();

static double Limit, Upper;

static void drive(ros::Publisher &Out, double Speed, bool Capped) {
  if (Capped)
    Speed = Limit;
  // CHECK: comparisons of {{.*}}: 1
  // CHECK: derived 'limit' relation > as 2 * x distance 1 {{.*}} at [[#@LINE+1]]:13
  if (Speed > Upper)
    Out.publish(std_msgs::Number());
}

void run(ros::NodeHandle &Handle, ros::Publisher &Out, bool Capped) {
  Handle.param("limit", Limit, 0.5);
  Upper = Limit * 2;
  drive(Out, sensed(), Capped);
}
