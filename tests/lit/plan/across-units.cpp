// RUN: rm -rf %t && mkdir -p %t
// RUN: %native -c %inputs/ros.cpp -o %t/ros.o
// RUN: %compile -O2 -fPIC -DCHECKS %s -o %t/checks.o
// RUN: %compile -O2 -fPIC -DMAIN %s -o %t/main.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=robot -Wl,-mllvm,-tpc-plan-out=%t/robot.plan %t/main.o %t/checks.o %t/ros.o -o %t/robot
// RUN: %link -O2 -shared -Wl,-mllvm,-tpc-link-unit=checks -Wl,-mllvm,-tpc-plan=%t/robot.plan -Wl,-mllvm,-tpc-static-info=%t/checks.json %t/checks.o -o %t/libchecks.so
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=main -Wl,-mllvm,-tpc-plan=%t/robot.plan -Wl,-mllvm,-tpc-static-info=%t/main.json %t/main.o %t/libchecks.so -rdynamic %t/ros.o -Wl,-rpath,%t -o %t/main
// RUN: %t/main | FileCheck %s
// RUN: FileCheck %s --check-prefix=JSON --input-file=%t/checks.json
//
// A library compares what the program reads and publishes. The plan of both as
// one program makes each report, also for the calls of one function that pass
// different parameters: from the program, the calls enter it, and from the
// library itself they enter a copy.
#include <ros/ros.h>

// With low = 1, middle = 20 and high = 100, 10 is above the first alone.
// CHECK: report 1 cmp 10 thresh 1 res 1 key [[LOW:....]]
// CHECK-NEXT: published out 0
// CHECK-NEXT: report 0 cmp 10 thresh 20 res 0
// CHECK-NEXT: report 0 cmp 10 thresh 100 res 0 key
// CHECK-NOT: {{report|published}}

// JSON: "processes": [
// JSON-NEXT: "robot"
// JSON: "source": "low"
// JSON: "source": "middle"
// JSON: "comparisons": 2,

bool above(double Value, double Threshold);
bool aboveMiddle(double Value);
extern double Middle;

#ifdef CHECKS
double Middle;
__attribute__((noinline)) bool above(double Value, double Threshold) {
  return Value > Threshold;
}
bool aboveMiddle(double Value) { return above(Value, Middle); }
#endif

#ifdef MAIN
int main(int Argc, char **) {
  ros::NodeHandle Handle;
  double Low, High;
  Handle.param("low", Low, 1.0);
  Handle.param("middle", Middle, 20.0);
  Handle.param("high", High, 100.0);
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  double Value = 10 * Argc;
  if (above(Value, Low))
    Out.publish(std_msgs::Number());
  if (aboveMiddle(Value))
    Out.publish(std_msgs::Number());
  if (Value > High)
    Out.publish(std_msgs::Number());
}
#endif
