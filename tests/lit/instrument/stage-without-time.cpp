// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O1 %s -o %t.o
// RUN: %link -O1 -Wl,-mllvm,-tpc-spend=tpc::PointsToAnalysis -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.json %t.o %t.ros.o -o %t 2>&1 | FileCheck %s --check-prefix=WARN
// RUN: %t | FileCheck %s
// RUN: FileCheck %s --check-prefix=JSON --input-file=%t.json
//
// A stage that has no time left does not end those after it: without any
// pointer followed, a comparison in one function is still found. A function that
// would have to be copied for its calls reports nothing, since one report would
// stand for both.
// WARN: warning: node: the analysis does not fit into {{.*}} others may be missing
// WARN-NOT: {{.}}
// JSON-DAG: "incomplete": "the analysis does not fit into
// JSON-DAG: "not_instrumented": 2
#include <ros/ros.h>

#include <cstdio>

__attribute__((noinline)) static bool above(double Value, double Limit) {
  return Value > Limit;
}

int main() {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  double Low = 0, First = 0, Second = 0;
  Handle.param("low", Low, 1.0);
  Handle.param("first", First, 2.0);
  Handle.param("second", Second, 9.0);
  std_msgs::Number Message;
  Message.data = 5;
  // CHECK: report {{.*}}
  // CHECK-NOT: report
  if (Message.data > Low)
    Out.publish(Message);
  if (above(Message.data, First) && above(Message.data, Second))
    Out.publish(Message);
}
