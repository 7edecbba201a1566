// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>' %t.o | FileCheck %s
//
// A name is what the last change before the read made it, on every path to the
// read; if the paths differ, it is not known.
#include <ros/ros.h>

void load(ros::NodeHandle &Handle, double &A, double &B, bool Left) {
  std::string Changed = "a";
  // CHECK: 'a'
  Handle.param(Changed, A, 1.0);
  Changed = "b";
  // CHECK: 'b'
  Handle.param(Changed, B, 1.0);
  if (Left)
    Changed = "left";
  // CHECK: '<dynamic>'
  Handle.param(Changed, B, 1.0);
  if (Left)
    Changed = "same";
  else
    Changed = "same";
  // CHECK: 'same'
  // CHECK: 'same'
  Handle.param(Changed, A, 1.0);
  Handle.param(Changed, B, 1.0);
  for (int I = 0; I < 3; ++I) {
    // CHECK: '<dynamic>'
    Handle.param(Changed, A, 1.0);
    Changed += "again";
  }
}
