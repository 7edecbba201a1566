// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -fPIC -O2 -DLIBRARY %s -o %t.lib.o
// RUN: %link -O2 -shared %t.lib.o -o %t.so
// RUN: %native -rdynamic %s %t.ros.o %t.so -o %t
// RUN: env PARAM_low=1 PARAM_high=2 %t | FileCheck %s
//
// If a program replaces a weak function of a library, the calls in the library
// run what they ran without the passes: the program's function and, through the
// alias, which nobody replaced, its own.
// CHECK: low 42 high 42 alias 2
// CHECK: report 0 cmp 7 thresh 42
#include <ros/ros.h>

#include <cstdio>

extern "C" void step(double V);

#ifdef LIBRARY
extern "C" __attribute__((weak, noinline)) double
load(ros::NodeHandle &Handle, const char *Name) {
  double Value = 0;
  Handle.getParam(Name, Value);
  return Value;
}
extern "C" double alias(ros::NodeHandle &Handle, const char *Name)
    __attribute__((alias("load")));

void step(double V) {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  double Low = load(Handle, "low"), High = load(Handle, "high");
  std::printf("low %g high %g alias %g\n", Low, High, alias(Handle, "high"));
  std::fflush(stdout);
  if (V > Low || V < High - 100)
    Out.publish(std_msgs::Number());
}
#else
extern "C" double load(ros::NodeHandle &, const char *) { return 42; }
int main() { step(7); }
#endif
