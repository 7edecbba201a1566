// RUN: rm -rf %t && mkdir -p %t
// RUN: %native -c %inputs/ros.cpp -o %t/ros.o
// RUN: %compile -O2 %s -o %t/before.o
// RUN: %compile -O2 -DCHANGED=+1 %s -o %t/after.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-plan-out=%t/node.plan %t/before.o %t/ros.o -o %t/before
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-plan=%t/node.plan -Wl,-mllvm,-tpc-static-info=%t/node.json %t/after.o %t/ros.o -o %t/after 2>&1 | FileCheck %s --check-prefix=SAYS
// RUN: %t/after | FileCheck %s
// RUN: FileCheck %s --check-prefix=JSON --input-file=%t/node.json
//
// What a plan says of a function that has changed since holds no more: it is
// left out, counted and told. The rest of the plan is used.
// SAYS: warning: node: the plan of node is about other code: 1 functions differ, and 1 reports are left out
// SAYS-NOT: {{.}}
// JSON-DAG: "comparisons": 1
// JSON-DAG: "not_instrumented": 1
// JSON-DAG: "source": "same"
#include <ros/ros.h>

#ifndef CHANGED
#define CHANGED
#endif

static ros::NodeHandle Handle;
static ros::Publisher Out;

// Both are 1 and are compared with 5.
// CHECK: report 1 cmp 5 thresh 1
// CHECK-NEXT: published out 0
// CHECK-NEXT: published out 0
// CHECK-NOT: {{report|published}}
__attribute__((noinline)) void same(double V) {
  double Limit;
  Handle.param("same", Limit, 1.0);
  if (V > Limit)
    Out.publish(std_msgs::Number());
}

__attribute__((noinline)) void other(double V) {
  double Limit;
  Handle.param("other", Limit, 1.0);
  if (V CHANGED > Limit)
    Out.publish(std_msgs::Number());
}

int main(int Argc, char **) {
  Out = Handle.advertise<std_msgs::Number>("out", 1);
  same(5 * Argc);
  other(5 * Argc);
}
