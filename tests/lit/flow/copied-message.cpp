// REQUIRES: ros1-headers
// RUN: %compile-real -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>'
// %t.o | FileCheck %s
//
// A message is copied as a whole and the copy is published: every part of what
// was copied is shown, not only the first.
#include <ros/ros.h>
#include <std_msgs/ColorRGBA.h>

struct Lamp {
  std_msgs::ColorRGBA Color;
};

static double Limit, Heap;
static Lamp Front;

// CHECK: comparisons of {{.*}}: 2
void run(ros::Publisher &Out, double Value) {
  // CHECK-DAG: 'limit'{{.*}} at [[#@LINE+1]]:
  if (Value > Limit)
    Front.Color.g = 1;
  std_msgs::ColorRGBA Copy = Front.Color;
  Out.publish(Copy);
  auto *Made = new std_msgs::ColorRGBA;
  // CHECK-DAG: 'heap'{{.*}} at [[#@LINE+1]]:
  if (Value > Heap)
    Made->b = 1;
  std_msgs::ColorRGBA Other = *Made;
  Out.publish(Other);
}

int main(int Count, char **Arguments) {
  ros::init(Count, Arguments, "node");
  ros::NodeHandle Handle;
  Handle.param("limit", Limit, 1.0);
  Handle.param("heap", Heap, 1.0);
  ros::Publisher Out = Handle.advertise<std_msgs::ColorRGBA>("out", 1);
  run(Out, ros::Time::now().toSec());
}
