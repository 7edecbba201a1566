// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A publish behind one, two and three calls: each call adds one to the
// distance. A loop around the call does not hide what controls the loop.
#include <ros/ros.h>

static void third(ros::Publisher &Out) { Out.publish(std_msgs::Number()); }
static void second(ros::Publisher &Out) { third(Out); }
static void first(ros::Publisher &Out) { second(Out); }

static void loop(ros::Publisher &Out, int Times) {
  while (Times-- > 0)
    Out.publish(std_msgs::Number());
}

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  double A, B;
  Handle.param("a", A, 1.0);
  Handle.param("b", B, 2.0);
  // CHECK: comparisons of {{.*}}: 2
  // CHECK: 'a' relation > as x distance 4 {{.*}} at [[#@LINE+1]]:
  if (V > A)
    first(Out);
  // CHECK: 'b' relation > as x distance 3 {{.*}} at [[#@LINE+1]]:
  if (V > B)
    loop(Out, 3);
}
