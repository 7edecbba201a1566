// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %opt -disable-output -tpc-profile=thesis -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s --check-prefix=THESIS
//
// The result of a function matters where it is used. A condition under which the
// function is called elsewhere, for a line of the log, decides nothing about it.
// What the function writes is another matter.
#include <ros/ros.h>
#include <cstdio>

static double Height;
static unsigned Asked;

__attribute__((noinline)) static double height() { return Height > 0 ? Height : 0; }
__attribute__((noinline)) static unsigned asked() { return ++Asked; }

// CHECK: comparisons of {{.*}}: 2
// THESIS: comparisons of {{.*}}: 3
void step(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  double Low, Often, High;
  Handle.param("low", Low, 1.0);
  Handle.param("often", Often, 2.0);
  Handle.param("high", High, 3.0);
  // CHECK-NOT: 'low'
  // THESIS: parameter 'low'
  if (V < Low)
    std::printf("low at %f\n", height());
  // CHECK: parameter 'often' {{.*}} at [[#@LINE+1]]:9
  if (V < Often)
    std::printf("%u\n", asked());
  // CHECK: parameter 'high' {{.*}} at [[#@LINE+1]]:16
  if (height() > High && Asked > 3)
    Out.publish(std_msgs::Number());
}
