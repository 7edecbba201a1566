// RUN: rm -rf %t && mkdir -p %t
// RUN: %native -c %inputs/ros.cpp -o %t/ros.o
// RUN: %compile -O2 -fPIC -DCHECKS %s -o %t/checks.o
// RUN: %compile -O2 -fPIC -DMAIN %s -o %t/main.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=robot -Wl,-mllvm,-tpc-plan-out=%t/robot.plan %t/main.o %t/checks.o %t/ros.o -o %t/robot
// RUN: %link -O2 -shared -Wl,-mllvm,-tpc-link-unit=checks -Wl,-mllvm,-tpc-plan=%t/robot.plan -Wl,-mllvm,-tpc-static-info=%t/checks.json %t/checks.o -o %t/libchecks.so
// RUN: FileCheck %s --check-prefix=JSON --input-file=%t/checks.json
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=main -Wl,-mllvm,-tpc-plan=%t/robot.plan %t/main.o %t/libchecks.so -rdynamic %t/ros.o -Wl,-rpath,%t -o %t/main
// RUN: %t/robot | FileCheck %s
// RUN: %t/main | FileCheck %s --check-prefix=APART --implicit-check-not=report
//
// Two calls from another unit pass different parameters, and enter one function:
// it cannot report either of them. In one program both report.
#include <ros/ros.h>

// CHECK: report 1 cmp 10 thresh 1
// CHECK: report 0 cmp 10 thresh 100

// APART: published out 0

// JSON: "comparisons": 2,
// JSON: "not_instrumented": 2,

bool above(double Value, double Threshold);

#ifdef CHECKS
__attribute__((noinline)) bool above(double Value, double Threshold) {
  return Value > Threshold;
}
#endif

#ifdef MAIN
int main(int Argc, char **) {
  ros::NodeHandle Handle;
  double Low, High;
  Handle.param("low", Low, 1.0);
  Handle.param("high", High, 100.0);
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  if (above(10 * Argc, Low))
    Out.publish(std_msgs::Number());
  if (above(10 * Argc, High))
    Out.publish(std_msgs::Number());
}
#endif
