// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// Comparisons with constants that an exposing statement depends on: literals,
// macros, enumerators, constants that the compiler folds, loop bounds, and
// those in a function whose result decides.
#include <ros/ros.h>

#define MOST 12
constexpr int Folded = 4;
const double Double = 2.5;
enum State { Idle, Moving };

static bool small(double V);

void step(ros::Publisher &Out, double V, unsigned N, State S, int *P, bool B) {
  // CHECK-LABEL: comparisons with constants: 8
  // CHECK-DAG: constant '3' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:9
  if (V > 3)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: constant '12' relation >= as x distance 1 {{.*}} at [[#@LINE+1]]:9
  if (N >= MOST)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: constant '1' relation == as x distance 1 {{.*}} at [[#@LINE+1]]:9
  if (S == Moving)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: constant '2.5' relation < as x distance 1 {{.*}} at [[#@LINE+1]]:14
  if (Double > V)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: constant '4' relation < as x distance 1 {{.*}} at [[#@LINE+1]]:21
  for (int I = 0; I < Folded; ++I)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: constant '-1' relation == as x distance 1 {{.*}} at [[#@LINE+1]]:10
  if (*P == -1)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: constant '5' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:26
  if (__builtin_expect(V > 5, 1))
    Out.publish(std_msgs::Number());
  if (small(V))
    Out.publish(std_msgs::Number());
}

static bool small(double V) {
  // CHECK-DAG: constant '0.125' relation < as x distance 1 {{.*}} at [[#@LINE+1]]:12
  return V < 0.125;
}
