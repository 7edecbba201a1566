// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A value that is passed to a function together with a message is in the
// message only if the function puts it there.
#include <ros/ros.h>

static int Limit, Traced;

static void trace(std_msgs::Number &, int Level) { Traced = Level; }
static void fill(std_msgs::Number &Message, int Level) { Message.data = Level; }

void run(ros::NodeHandle &Handle, ros::Publisher &Out, int N) {
  Handle.param("limit", Limit, 1);
  std_msgs::Number Message;
  // CHECK: comparisons of {{.*}}: 1
  trace(Message, N > Limit ? 1 : 0);
  // CHECK: parameter 'limit' relation > {{.*}} at [[#@LINE+1]]:19
  fill(Message, N > Limit ? 1 : 0);
  Out.publish(Message);
}
