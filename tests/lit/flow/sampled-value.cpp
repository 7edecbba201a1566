// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A value that a loop moves on by arithmetic is sampled or accumulated: it is no
// threshold, although it began as a parameter. What is only limited in a loop,
// or counted down, still is.
#include <algorithm>
#include <ros/ros.h>

static double Low, Step, Highest, Decay;
static int Retries;

// CHECK: comparisons of {{.*}}: 2
void input(ros::Publisher &Out, const double *Values) {
  double Sample = Low;
  for (int I = 0; I < 10; ++I) {
    if (Values[I] > Sample)
      Out.publish(std_msgs::Number());
    Sample += Step;
  }
  double Level = Decay;
  for (int I = 0; I < 10; ++I) {
    Level = Values[I] > 0 ? Level * 0.9 : Decay;
    if (Values[I] > Level)
      Out.publish(std_msgs::Number());
  }
  double Limit = Highest;
  for (int I = 0; I < 10; ++I) {
    // CHECK-DAG: 'highest' relation > {{.*}} at [[#@LINE+1]]:
    if (Values[I] > Limit)
      Out.publish(std_msgs::Number());
    if (Values[I] < 0)
      Limit = 100;
  }
  // CHECK-DAG: 'retries' relation < {{.*}} at [[#@LINE+1]]:
  for (int Left = Retries; Left > 0; --Left)
    Out.publish(std_msgs::Number());
}

void run(ros::NodeHandle &Handle, ros::Publisher &Out, const double *Values) {
  Handle.param("low", Low, 1.0);
  Handle.param("step", Step, 1.0);
  Handle.param("highest", Highest, 1.0);
  Handle.param("decay", Decay, 1.0);
  Handle.param("retries", Retries, 3);
  input(Out, Values);
}
