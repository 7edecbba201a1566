// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %opt -disable-output -tpc-profile=thesis -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s --check-prefix=THESIS
//
// A comparison whose outcome is itself published decides what others see,
// although no branch depends on it. One whose outcome is only stored does not.
// In the thesis, only branches count.
#include <ros/ros.h>

static double Limit, Low, High, Kept;
static bool Last;

static bool isInside(double V) { return V > Low && V < High; }

// THESIS-NOT: 'limit'
// CHECK: comparisons of {{.*}}: 3
// CHECK-DAG: 'limit' relation < {{.*}} at [[#@LINE+3]]:20
void input(ros::Publisher &Out, double V) {
  std_msgs::Number Message;
  Message.data = V < Limit;
  Out.publish(Message);
  // CHECK-DAG: 'low' relation > {{.*}} at [[#@LINE-9]]:
  // CHECK-DAG: 'high' relation < {{.*}} at [[#@LINE-10]]:
  Message.data = isInside(V);
  Out.publish(Message);
  Last = V > Kept;
}

void run(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  Handle.param("limit", Limit, 1.0);
  Handle.param("low", Low, 1.0);
  Handle.param("high", High, 1.0);
  Handle.param("kept", Kept, 1.0);
  input(Out, V);
}
