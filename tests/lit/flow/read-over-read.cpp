// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A variable that a second parameter is read into no longer holds the first if
// the read has a default; getParam may leave it unchanged.
#include <ros/ros.h>

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  double Always, Perhaps;
  Handle.param("first", Always, 1.0);
  Handle.param("second", Always, 2.0);
  Handle.param("third", Perhaps, 3.0);
  Handle.getParam("fourth", Perhaps);
  // CHECK: comparisons of {{.*}}: 3
  // CHECK-NOT: 'first'
  // CHECK-DAG: parameter 'second' {{.*}} at [[#@LINE+3]]:9
  // CHECK-DAG: parameter 'third' {{.*}} at [[#@LINE+4]]:9
  // CHECK-DAG: parameter 'fourth' {{.*}} at [[#@LINE+3]]:9
  if (V > Always)
    Out.publish(std_msgs::Number());
  if (V > Perhaps)
    Out.publish(std_msgs::Number());
}
