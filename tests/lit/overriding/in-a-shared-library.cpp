// RUN: %compile -O2 -fPIC %s -o %t.o
// RUN: %link -shared -Wl,-mllvm,-tpc-static-info=%t.json %t.o -o %t.so
// RUN: FileCheck %s < %t.json
// RUN: %link -r -nostdlib -Wl,-mllvm,-tpc-static-info=%t.json %t.o -o %t.other.o
// RUN: FileCheck %s --check-prefix=PART < %t.json
//
// An interface of the own package: in a shared library, whoever loads it calls
// what nothing in it calls. What is called in it, here by a thunk, counts as its
// own.
#include <ros/ros.h>

static double Far, Inner;

struct Shape {
  virtual ~Shape() = default;
  virtual bool holds(double Value) = 0;
  virtual bool touches(double Value) = 0;
};

struct Named {
  virtual ~Named() = default;
};

// CHECK-DAG: "topic": "holds -> result"
// CHECK-NOT: touches -> result
// PART-NOT: holds -> result
struct Circle : Named, Shape {
  bool holds(double Value) override { return Value < Far; }
  bool touches(double Value) override { return Value < Inner; }
};

Shape *shape(ros::NodeHandle &Handle) {
  Handle.param("far", Far, 1.0);
  Handle.param("inner", Inner, 1.0);
  return new Circle();
}

bool asked(Shape *S) { return S->touches(3); }
