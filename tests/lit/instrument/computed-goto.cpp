// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %s -o %t.o
// RUN: %link -O2 %t.o %t.ros.o -o %t
// RUN: env PARAM_limit=1 PARAM_other=5 %t | FileCheck %s
// RUN: %native %s %inputs/ros.cpp -o %t.plain
// RUN: env PARAM_limit=1 PARAM_other=5 %t.plain > %t.expected
// RUN: env PARAM_limit=1 PARAM_other=5 %t > %t.all
// RUN: grep -v report %t.all | diff %t.expected -
//
// A function that jumps to labels by their addresses in a table runs as before:
// it reads two parameters for its callers and is not copied for them, and
// comparisons inside it are reported.
#include <ros/ros.h>

#include <cstdio>

__attribute__((noinline)) double get(ros::NodeHandle &Handle, const char *Name,
                                     int Way) {
  static void *const Table[] = {&&Plain, &&More};
  double Value = 0;
  goto *Table[Way & 1];
Plain:
  Handle.getParam(Name, Value);
  return Value;
More:
  Handle.getParam(Name, Value);
  return Value > 3 ? Value + 10 : Value;
}

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  for (int Way = 0; Way < 2; ++Way) {
    double Limit = get(Handle, "limit", Way), Other = get(Handle, "other", Way);
    std::printf("%g %g\n", Limit, Other);
    std::fflush(stdout);
    // CHECK: 1 5
    // CHECK: report 0 cmp 1 thresh 1 res 0
    // CHECK: 1 15
    // CHECK: report 0 cmp 1 thresh 1 res 0
    if (Argc > Limit)
      Out.publish(std_msgs::Number());
    if (Argc > Other)
      Out.publish(std_msgs::Number());
  }
}
