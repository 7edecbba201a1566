// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// The place of a flag that is the last operand of a condition whose outcome is
// used further is where the flag is read, not where the outcome decides.
#include <ros/ros.h>

static bool Pitch, Roll;

static bool lateral() {
  // CHECK-DAG: flag 'pitch' relation flag {{.*}} in _ZL7lateralv at [[#@LINE+2]]:16
  // CHECK-DAG: flag 'roll' relation flag {{.*}} in _ZL7lateralv at [[#@LINE+1]]:19
  return Pitch && Roll;
}

void step(ros::NodeHandle &Handle, ros::Publisher &Out) {
  Handle.param("pitch", Pitch, true);
  Handle.param("roll", Roll, true);
  // CHECK-NOT: at [[#@LINE+1]]
  if (lateral())
    Out.publish(std_msgs::Number());
}
