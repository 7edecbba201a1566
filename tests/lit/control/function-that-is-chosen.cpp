// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A predicate that chooses the function in a pointer decides what the function publishes;
// a predicate that chooses among functions that publish nothing decides nothing.
#include <ros/ros.h>

static int Limit, Level;
static ros::Publisher *Out;

static void loud() { Out->publish(std_msgs::Number()); }
static void quiet() {}
static void silent() {}

// CHECK: comparisons of {{.*}}: 1
// CHECK-NEXT: 'limit' {{.*}} at [[#@LINE+3]]:25
// CHECK-NEXT: comparisons with constants
void step(int Value) {
  void (*How)() = Value > Limit ? &loud : &quiet;
  How();
  void (*Other)() = Value > Level ? &silent : &quiet;
  Other();
}

void run(ros::NodeHandle &Handle, ros::Publisher &Of, int Value) {
  Handle.param("limit", Limit, 1);
  Handle.param("level", Level, 1);
  Out = &Of;
  step(Value);
}
