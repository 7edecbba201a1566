// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes=tpc -tpc-static-info=%t.json %t.o
// RUN: %python %inputs/show.py paths %t.json | FileCheck %s --match-full-lines
//
// The path through a throw names the call that throws, and what does not catch it.
#include <ros/ros.h>

// CHECK-DAG: most: 6 steps

double Most;
struct Fault {};

void check(double V) {
  // CHECK-DAG: most 2: compare [[#@LINE+1]] check: compared: V > Most; decides whether check() throws
  if (V > Most)
    // CHECK-DAG: most 3: return [[#@LINE+1]] check: thrown by check()
    throw Fault();
}
void checkAll(double V) {
  // CHECK-DAG: most 4: return [[#@LINE+1]] checkAll: let through by checkAll()
  check(V);
}
void step(ros::NodeHandle &Handle, double V) {
  // CHECK-DAG: most 1: read [[#@LINE+1]] step: most read into Most
  Handle.getParam("most", Most);
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  // CHECK-DAG: most 5: control [[#@LINE+1]] step: guards publish() on out by whether checkAll() throws
  checkAll(V);
  // CHECK-DAG: most 6: expose [[#@LINE+1]] step: published on out
  Out.publish(std_msgs::Number());
}
