// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %s -o %t.o
// RUN: %link -O2 %t.o %t.ros.o -o %t
// RUN: env PARAM_p=1 %t | FileCheck %s
//
// The result of an atomic update is compared with the parameter, and reported;
// it stays a single update.
// CHECK: report 0 cmp 0 thresh 1
// CHECK: report 0 cmp 1 thresh 1
// CHECK: report 1 cmp 2 thresh 1
// CHECK: published out 3
#include <atomic>
#include <ros/ros.h>

static std::atomic<int> Count;

int main() {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  int P;
  Handle.param("p", P, 1);
  for (int Round = 0; Round < 3; ++Round)
    if (Count.fetch_add(1) > P) {
      std_msgs::Number Message;
      Message.data = Count;
      Out.publish(Message);
    }
}
