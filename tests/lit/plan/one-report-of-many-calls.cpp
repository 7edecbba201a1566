// RUN: rm -rf %t && mkdir -p %t
// RUN: %native -c %inputs/ros.cpp -o %t/ros.o
// RUN: %compile -O2 -fPIC -DCHECKS %s -o %t/checks.o
// RUN: %compile -O2 -fPIC -DMAIN %s -o %t/main.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=robot -Wl,-mllvm,-tpc-plan-out=%t/robot.plan %t/main.o %t/checks.o %t/ros.o -o %t/robot
// RUN: %link -O2 -shared -Wl,-mllvm,-tpc-link-unit=checks -Wl,-mllvm,-tpc-plan=%t/robot.plan %t/checks.o -o %t/libchecks.so
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=main -Wl,-mllvm,-tpc-plan=%t/robot.plan %t/main.o %t/libchecks.so -rdynamic %t/ros.o -Wl,-rpath,%t -o %t/main
// RUN: %t/robot | FileCheck %s --implicit-check-not=report
// RUN: %t/main | FileCheck %s --implicit-check-not=report
//
// A function has a copy for each of its calls in the process, and is one
// function in its own unit: each evaluation is one report, not one per copy.
#include <ros/ros.h>

// CHECK: report 1 cmp 10 thresh 1
// CHECK: report 1 cmp 20 thresh 1

bool above(double Value, double Threshold);

#ifdef CHECKS
__attribute__((noinline)) bool above(double Value, double Threshold) {
  return Value > Threshold;
}
#endif

#ifdef MAIN
int main(int Argc, char **) {
  ros::NodeHandle Handle;
  double Low;
  Handle.param("low", Low, 1.0);
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  if (above(10 * Argc, Low))
    Out.publish(std_msgs::Number());
  if (above(20 * Argc, Low))
    Out.publish(std_msgs::Number());
  // Only because of this one are there copies.
  if (Argc > 1 && above(30, 7))
    Out.publish(std_msgs::Number());
}
#endif
