// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// The place of a comparison in std::min, std::max or std::clamp is their call;
// one in another library function is counted, not listed.
#include <ros/ros.h>

#include <algorithm>

double Limit;

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double V, double W) {
  Handle.param("limit", Limit, 0.5);
  std_msgs::Number Message;
  // std::max(a, b) is `a < b ? b : a`, std::min(a, b) is `b < a ? b : a`.
  // CHECK-DAG: parameter 'limit' relation < as x {{.*}} in _Z4step{{.*}} at [[#@LINE+1]]:18
  Message.data = std::max(V, Limit);
  Out.publish(Message);
  // CHECK-DAG: parameter 'limit' relation < as x {{.*}} in _Z4step{{.*}} at [[#@LINE+1]]:18
  Message.data = std::min(Limit, V);
  Out.publish(Message);
  // CHECK-DAG: derived 'limit' relation < as -1 * x {{.*}} in _Z4step{{.*}} at [[#@LINE+1]]:18
  Message.data = std::clamp(V, -Limit, 100.0);
  Out.publish(Message);
  // Each element of a list is compared with the result so far.
  // CHECK-DAG: 'limit' {{.*}} at [[#@LINE+1]]:18
  Message.data = std::min({V, W, Limit});
  Out.publish(Message);
  // CHECK-NOT: at [[#@LINE+2]]:
  double Both[2] = {Limit, V};
  Message.data = *std::max_element(Both, Both + 2);
  Out.publish(Message);
}
