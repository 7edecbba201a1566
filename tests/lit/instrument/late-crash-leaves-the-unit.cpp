// RUN: %compile -O0 %s -o %t.o
// RUN: %opt -S -passes=verify %t.o -o %t.before.ll
// RUN: %opt -S -passes=tpc -tpc-instrument=false %t.o -o %t.off.ll
// RUN: diff %t.before.ll %t.off.ll
// RUN: %opt -S -passes=tpc -tpc-link-unit=node -tpc-inject-late-failure=crash %t.o -o %t.crash.ll 2>&1 | FileCheck %s
// RUN: diff %t.before.ll %t.crash.ll
// RUN: %opt -S -passes=tpc -tpc-inject-late-failure=allocation %t.o -o %t.allocation.ll
// RUN: diff %t.before.ll %t.allocation.ll
// RUN: %opt -S -passes=tpc %t.o | FileCheck %s --check-prefix=REPORTS
//
// What reports need (std::max inlined, `load` copied for each of its calls) is
// not done to a link unit that gets none: neither if the analysis fails at its
// end, nor if only the static information is requested.
// CHECK: warning: node: the analysis crashed; this link unit is not changed
// REPORTS-DAG: call void @_Z7log_onePcbddb
// REPORTS-DAG: define internal {{.*}} @_Z4loadRN3ros10NodeHandleEPKcRd.tpc.1(
#include <ros/ros.h>

#include <algorithm>

static double Low, High;

void load(ros::NodeHandle &Handle, const char *Name, double &To) {
  Handle.param(Name, To, 2.0);
}

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  load(Handle, "low", Low);
  load(Handle, "high", High);
  std_msgs::Number Message;
  Message.data = std::max(double(Argc), Low);
  if (Argc < High)
    Out.publish(Message);
}
