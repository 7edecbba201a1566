// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A predicate that decides whether a whole object is copied decides what a
// library function reads from it: publish 1, the store to the message 2, the
// call 3, the copy 4.
#include <ros/ros.h>

struct Stamp {
  unsigned Sec, NSec;
};
double since(const Stamp &A, const Stamp &B);

static double Limit;
static Stamp Last;

void run(ros::NodeHandle &Handle, ros::Publisher &Out, double V,
         const Stamp &Now) {
  Handle.param("limit", Limit, 1.0);
  // CHECK: parameter 'limit' relation > as x distance 4 {{.*}} at [[#@LINE+1]]:9
  if (V > Limit)
    Last = Now;
  std_msgs::Number Message;
  Message.data = since(Now, Last);
  Out.publish(Message);
}
