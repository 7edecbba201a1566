// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes=tpc -tpc-link-unit=node -tpc-package=pack -tpc-source-root=%S -tpc-static-info=%t.json %t.o
// RUN: %python -m json.tool --sort-keys %t.json %t.sorted
// RUN: FileCheck %s --input-file=%t.sorted
//
// What the file says about a comparison.
// CHECK: "comparisons": [
// CHECK: "column": 9,
// CHECK-NEXT: "default": 4.5,
// CHECK-NEXT: "distance": 1,
// CHECK: "file": "static-info.cpp",
// CHECK: "function": "step(ros::NodeHandle&, double)",
// CHECK-NEXT: "key": "{{[0-9a-f]+-[0-9a-f]+-5[0-9a-f]+-[89ab][0-9a-f]+-[0-9a-f]+}}",
// CHECK-NEXT: "lineno": [[#@LINE+26]],
// CHECK-NEXT: "loop_depth": 0,
// CHECK-NEXT: "name": "Limit",
// CHECK-NEXT: "other_thresholds": 0,
// CHECK: "read_at": {
// CHECK-NEXT: "file": "static-info.cpp",
// CHECK-NEXT: "lineno": [[#@LINE+18]]
// CHECK: "relation": ">",
// CHECK-NEXT: "source": "limit",
// CHECK-NEXT: "source_code": "if (V > Limit) // \u201cenough\u201d",
// CHECK-NEXT: "topic": "out",
// CHECK-NEXT: "transform": null,
// CHECK-NEXT: "type": "parameter"
// CHECK: "exposing_statements": 1,
// CHECK: "link_unit": "node",
// CHECK-NEXT: "not_exposed": [],
// CHECK-NEXT: "package": "pack",
// CHECK: "schema": 1,
// CHECK: "status": "ok",
#include <ros/ros.h>

void step(ros::NodeHandle &Handle, double V) {
  double Limit;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  Handle.param("limit", Limit, 4.5);

  if (V > Limit) // “enough”
    Out.publish(std_msgs::Number());
}
