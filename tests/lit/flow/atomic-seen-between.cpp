// RUN: %compile -O1 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// Other threads see an atomic store before it is replaced; they are assumed not
// to see a plain store.
#include <ros/ros.h>

static ros::Publisher Out;
static int Stage, Step;

void work(double Value, double High, double Low) {
  // CHECK-DAG: parameter 'high'
  __atomic_fetch_or(&Stage, Value > High, __ATOMIC_SEQ_CST);
  Step = Value < Low;
  Stage = 0;
  Step = 0;
}

void watch() {
  if (Stage)
    Out.publish(std_msgs::Number());
  if (Step)
    Out.publish(std_msgs::Number());
}

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  Out = Handle.advertise<std_msgs::Number>("out", 1);
  double High, Low;
  Handle.param("high", High, 1.0);
  Handle.param("low", Low, 1.0);
  work(Argc, High, Low);
  watch();
}
// CHECK-NOT: 'low'
