// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>' %t.o | FileCheck %s
//
// ParamCallFinder: name, type and default of the reads; the computed part of a
// name is dynamic; the inside of param() is not a read by the user.
#include <ros/ros.h>

void load(ros::NodeHandle &Handle, const std::string &Prefix) {
  double D;
  int I;
  bool B;
  // CHECK: parameter reads of {{.*}}: 4
  // CHECK-NEXT: ros::NodeHandle::param 'min_height' double default 0.25 in {{.*}} at [[#@LINE+1]]:10
  Handle.param("min_height", D, 0.25);
  // CHECK-NEXT: ros::NodeHandle::param 'count' int default -3 in {{.*}} at [[#@LINE+1]]:10
  Handle.param("count", I, -3);
  // CHECK-NEXT: ros::NodeHandle::getParam 'use' bool default null in {{.*}} at [[#@LINE+1]]:10
  Handle.getParam("use", B);
  // CHECK-NEXT: ros::NodeHandle::param '<dynamic>_limit' double default 1 in {{.*}} at [[#@LINE+1]]:10
  Handle.param(Prefix + "_limit", D, 1.0);
}
