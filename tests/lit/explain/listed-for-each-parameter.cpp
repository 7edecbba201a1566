// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes=tpc -tpc-max-listed=1 -tpc-static-info=%t.json %t.o
// RUN: %python %inputs/show.py spots %t.json | FileCheck %s --match-full-lines
//
// However few blind spots are listed, each parameter has one of each kind.
#include <ros/ros.h>

// CHECK: 5 blind spots, 3 listed

void show(double Value);
struct Message {
  double Limit;
};

void step(ros::NodeHandle &Handle) {
  double First, Second;
  Handle.param("first", First, 0.5);
  Handle.param("second", Second, 0.5);
  // CHECK-NEXT: lost_value first [[#@LINE+1]] step: handed to show(), which is not analysed
  show(First);
  show(First);
  // CHECK-NEXT: lost_value second [[#@LINE+1]] step: handed to show(), which is not analysed
  show(Second);
  show(Second);
  // CHECK-NEXT: unread second [[#@LINE+1]] step: stored into Message::Limit, and nothing here reads it
  (new Message)->Limit = Second;
}
