// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A predicate that decides whether a whole object is copied decides what is read
// from the copy: publish 1, the store to the message 2, the load 3, the copy 4.
#include <ros/ros.h>

struct Range {
  double Low, High;
  int Count;
};

static double Limit;
static Range Now, Next;

void run(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  Handle.param("limit", Limit, 1.0);
  // CHECK: parameter 'limit' relation > as x distance 4 {{.*}} at [[#@LINE+1]]:9
  if (V > Limit)
    Now = Next;
  std_msgs::Number Message;
  Message.data = Now.High;
  Out.publish(Message);
}
