// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>' %t.o | FileCheck %s
//
// A helper with sixty calls reads sixty parameters.
#include <ros/ros.h>

static void load(ros::NodeHandle &Handle, const std::string &Name, double &V) {
  if (!Handle.getParam(Name, V))
    V = 0;
}

#define SIX(N)                                                                 \
  load(Handle, #N "0", V), load(Handle, #N "1", V), load(Handle, #N "2", V),   \
      load(Handle, #N "3", V), load(Handle, #N "4", V), load(Handle, #N "5", V)

// CHECK: parameter reads of {{.*}}: 60
// CHECK-NOT: <dynamic>
// CHECK-DAG: 'a0'
// CHECK-DAG: 'a5'
// CHECK-DAG: 'j5'
int main() {
  ros::NodeHandle Handle;
  double V;
  SIX(a), SIX(b), SIX(c), SIX(d), SIX(e);
  SIX(f), SIX(g), SIX(h), SIX(i), SIX(j);
}
