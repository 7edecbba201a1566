// RUN: %compile -O1 %s -o %t.o
// RUN: %opt -disable-output -passes=tpc -tpc-static-info=%t.json %t.o
// RUN: FileCheck %s --input-file=%t.json
//
// An atomic update of a counter is a write: what decides whether it counts
// decides what is published because of it. Both are explained.
#include <atomic>
#include <ros/ros.h>

std::atomic<int> Count{0};

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double Limit;
  Handle.param("limit", Limit, 0.5);
  int Group;
  Handle.param("group", Group, 3);
  // CHECK-DAG: "source": "limit"
  if (Value > Limit)
    ++Count;
  // CHECK-DAG: "source": "group"
  if (Count >= Group)
    Out.publish(std_msgs::Number());
}
// CHECK-DAG: "status": "ok"
