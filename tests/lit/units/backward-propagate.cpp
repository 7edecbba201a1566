// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-backward-propagate>' %t.o | FileCheck %s
//
// BackwardPropagate: the distances of the predicates in the slice, by control and by
// data; a predicate that no exposing statement depends on is not in it. (The branch of
// an if has the place of the if; in versions after clang 19, that of its condition.)
#include <ros/ros.h>

int Count;

// CHECK: slice of {{.*}}: 3 predicates
void step(ros::Publisher &Out, int A, int B, int C, int D) {
  std_msgs::Number Message;
  // The publish uses the store, which is one step away.
  // CHECK: distance 2 in {{.*}} at [[#@LINE+1]]:{{7|9}} before ros::Publisher::publish
  if (A > 1)
    Message.data = 5;
  if (D > 1)
    ++Count;
  // CHECK: distance 2 in {{.*}} at [[#@LINE+1]]:{{7|9}} before
  if (B > 1) {
    // CHECK: distance 1 in {{.*}} at [[#@LINE+1]]:{{9|11}} before
    if (C > 1)
      Out.publish(Message);
  }
}
