// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-usage>' %t.o | FileCheck %s
//
// ParamUsageFinder: where a value is compared, the arithmetic before, and
// which predicates the outcome decides, with whether it reaches them
// unmerged.
#include <ros/ros.h>

double Other;

bool step(ros::NodeHandle &Handle, double V) {
  double Limit;
  Handle.param("limit", Limit, 0.5);
  // CHECK: 3 comparisons, 0 lost
  // CHECK-DAG: 'limit' as 2 * x compared in {{.*}} at [[#@LINE+1]]:14 decides at [[#@LINE+2]]:7
  bool B = V > 2 * Limit;
  if (B)
    return true;
  // CHECK-DAG: 'limit' as x + Other compared in {{.*}} at [[#@LINE+1]]:9 decides at [[#@LINE+1]]:
  if (V > Limit + Other)
    return false;
  // CHECK-DAG: 'limit' as x compared in {{.*}} at [[#@LINE+1]]:{{.*}} later decides at [[#@LINE+2]]:7
  bool C = Other > 3 && V < Limit;
  if (C)
    return false;
  return true;
}
