// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// ?: decides a published value, with sides without side effects (a select) and
// with calls (branches).
#include <ros/ros.h>

double costly();

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double Limit, Other;
  Handle.param("limit", Limit, 0.5);
  Handle.param("other", Other, 0.5);
  std_msgs::Number Message;
  // CHECK: comparisons of {{.*}}: 2
  // CHECK: 'limit' {{.*}} at [[#@LINE+1]]:24
  Message.data = Value > Limit ? 1 : 2;
  // CHECK: 'other' {{.*}} at [[#@LINE+1]]:25
  Message.data += Value < Other ? costly() : 0;
  Out.publish(Message);
}
