// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A pointer in a local object may lead anywhere if the object was copied to or
// passed to code that may have filled it, even if one pointer is stored there.
// CHECK: comparisons of {{.*}}: 2
#include <ros/ros.h>

struct Level {
  double High = 0;
};
struct Chosen {
  Level *Which = nullptr;
};

void choose(Chosen &Out);

static Level Shared;

void run(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  Level Mine;
  Handle.getParam("high", Shared.High);
  Chosen Filled;
  Filled.Which = &Mine;
  choose(Filled);
  // CHECK-DAG: parameter 'high' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:13
  if (Value > Filled.Which->High)
    Out.publish(std_msgs::Number());
  Chosen Copied, From;
  Copied.Which = &Mine;
  From.Which = &Shared;
  Copied = From;
  // CHECK-DAG: parameter 'high' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:13
  if (Value > Copied.Which->High)
    Out.publish(std_msgs::Number());
}
