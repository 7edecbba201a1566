// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-instrument-branches>' %t.o | FileCheck %s
//
// InstrumentBranches: a report stands before the predicate or, if its values do
// not reach the predicate, where the comparison is evaluated. (The branch of an
// if has the place of the if; in versions after clang 19, that of its condition.)
#include <ros/ros.h>

double Limit;

static bool enough(double V) {
  // CHECK-DAG: where it is evaluated at [[#@LINE+1]]:12 of the parameter at [[#@LINE+1]]:12
  return V > Limit;
}

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  Handle.param("limit", Limit, 0.5);
  if (enough(V))
    Out.publish(std_msgs::Number());
  // CHECK-DAG: before the predicate at [[#@LINE+1]]:{{7|9}} of the parameter at [[#@LINE+1]]:9
  if (V < Limit)
    Out.publish(std_msgs::Number());
}
