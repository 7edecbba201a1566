// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes=tpc -tpc-link-unit=node -tpc-static-info=%t.json %t.o
// RUN: FileCheck %s --input-file=%t.json
//
// A comparison of a text parameter whose outcome decides nothing is not a
// finding, and causes no failure.
// CHECK: "comparisons": 0,
// CHECK: "status": "ok"
#include <ros/ros.h>

bool Fast;

void load(ros::NodeHandle &Handle) {
  std::string Mode;
  Handle.param("mode", Mode, std::string("slow"));
  Fast = Mode == "fast";
}
