// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>' %t.o | FileCheck %s
//
// A name that was changed after it was made is not known; one that is used
// twice is.
#include <ros/ros.h>

void load(ros::NodeHandle &Handle, double &A, double &B) {
  std::string Changed = "a";
  Handle.param(Changed, A, 1.0);
  Changed = "b";
  // CHECK: '<dynamic>'
  // CHECK: '<dynamic>'
  Handle.param(Changed, B, 1.0);
  const std::string Same = "same";
  // CHECK: 'same'
  // CHECK: 'same'
  Handle.param(Same, A, 1.0);
  Handle.param(Same, B, 1.0);
}
