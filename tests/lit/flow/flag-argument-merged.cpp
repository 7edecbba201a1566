// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes=tpc -tpc-link-unit=node -tpc-static-info=%t.2.json %t.2.o
// RUN: FileCheck %s --input-file=%t.2.json
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes=tpc -tpc-link-unit=node -tpc-static-info=%t.0.json %t.0.o
// RUN: FileCheck %s --input-file=%t.0.json
//
// A flag that is an argument and is merged with another value before it decides
// is found at the predicate. The argument itself has no place where it could be
// reported, which is counted.
// CHECK-DAG: "not_instrumented": 1
// CHECK-DAG: "lineno": [[#@LINE+6]]
// CHECK-DAG: "status": "ok"
#include <ros/ros.h>

void step(ros::Publisher &Out, int Mode, double V) {
  int Use = V > 3 ? Mode : 1;
  switch (Use) {
  case 2:
    Out.publish(std_msgs::Number());
  }
}

void load(ros::NodeHandle &Handle, ros::Publisher &Out) {
  int Mode;
  Handle.param("mode", Mode, 1);
  step(Out, Mode, 1);
}
