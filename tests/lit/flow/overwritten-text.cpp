// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// Text that is assigned again no longer counts, text that is appended to does;
// two texts that are assigned the same literal do not become one.
#include <ros/ros.h>

struct Text {
  double data = 0;
  std::string name;
};

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  double Cut, Kept;
  Handle.param("cut", Cut, 1.0);
  Handle.param("kept", Kept, 1.0);
  // CHECK: comparisons of {{.*}}: 1
  // CHECK: parameter 'kept' {{.*}} at [[#@LINE+8]]:9
  Text First, Second;
  if (V > Cut)
    First.name = "high";
  else
    First.name = "low";
  First.name = "set";
  Out.publish(First);
  if (V > Kept)
    Second.name = "high";
  Second.name += "!";
  Out.publish(Second);
}
