// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes=tpc -tpc-static-info=%t.json %t.o
// RUN: %python %inputs/show.py not-exposed %t.json | FileCheck %s --match-full-lines
//
// Comparisons with parameters that no exposing statement depends on; if one
// instance of a template is exposed, the others are not listed.
#include <ros/ros.h>

// CHECK: 2 not exposed

static int Count;
static double Limit;

template <typename T> bool above(T Value) { return Value > Limit; }

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double Noise;
  bool Verbose;
  Handle.param("limit", Limit, 0.5);
  Handle.param("noise", Noise, 0.5);
  Handle.param("verbose", Verbose, true);
  if (above(static_cast<int>(Value)))
    ++Count;
  if (above(Value))
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: noise [[#@LINE+1]] step: if (Value > Noise)
  if (Value > Noise)
    ++Count;
  // CHECK-NEXT: verbose [[#@LINE+1]] step: if (Verbose)
  if (Verbose)
    ++Count;
}
