// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A jump to the end of a scope does not choose between results returned behind
// it, if all paths continue alike there: the extra path that clang adds, for a
// scope that is left to nowhere, does not count.
#include <ros/ros.h>

bool sensed();

static double twice(double In, int Value, int Limit) {
  bool Some = sensed();
  {
    int Inner = 1;
    if (Value < Limit)
      goto end;
  }
end:
  return In * 2;
}

// CHECK: comparisons of {{.*}}: 0
void step(ros::NodeHandle &Handle, ros::Publisher &Out, double In, int Value) {
  int Limit;
  Handle.param("limit", Limit, 3);
  std_msgs::Number Message;
  Message.data = twice(In, Value, Limit);
  Out.publish(Message);
}
