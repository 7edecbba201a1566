// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes=tpc -tpc-static-info=%t.json %t.o
// RUN: %python %inputs/show.py paths %t.json | FileCheck %s --match-full-lines
//
// What the standard library does with a value is part of the line of user code.
#include <ros/ros.h>

#include <utility>

// CHECK: low: 4 steps
// CHECK-NEXT: low 1: read [[#@LINE+5]] step: low read into Low
// CHECK-NEXT: low 2: store [[#@LINE+5]] step: stored into {{.*}}
// CHECK-NEXT: low 3: compare [[#@LINE+5]] step: compared: Value < {{.*}}; guards publish()
void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double Low;
  Handle.param("low", Low, 0.5);
  static std::pair<double, double> Range = std::make_pair(Low, 9.0);
  if (Value < Range.first)
    Out.publish(std_msgs::Number());
}
