// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>' -tpc-profile=thesis %t.o | FileCheck %s --check-prefix=THESIS
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>' %t.o | FileCheck %s --check-prefix=DEFAULT
//
// The profile of the thesis knows param() with an output variable, not
// getParam().
// THESIS: parameter reads of {{.*}}: 1
// DEFAULT: parameter reads of {{.*}}: 2
#include <ros/ros.h>

void load(ros::NodeHandle &Handle, double &A, double &B) {
  Handle.param("a", A, 4.5);
  Handle.getParam("b", B);
}
