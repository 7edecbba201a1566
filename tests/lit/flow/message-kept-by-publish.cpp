// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// What the library does with a message inside publish is not a write of the
// message: a field that was overwritten before does not count, the last write does.
#include <ros/ros.h>

// As in the headers of ROS, publish lets functions of its own store the message.
#line 1 "/usr/include/ros/advertised.h"
namespace ros {
void keep(void *Message);
template <typename M> __attribute__((noinline)) void hold(const M &Message) {
  keep(const_cast<M *>(&Message));
}
template <> inline void Publisher::publish(const std_msgs::Number &Message) const {
  hold(Message);
}
} // namespace ros
#line 20 "/home/user/node.cpp"

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double Low, High;
  Handle.param("low", Low, 0.5);
  Handle.param("high", High, 0.5);
  std_msgs::Number Message;
  if (Value < Low)
    Message.data = 1;
  Message.data = Value;
  // CHECK: comparisons of {{.*}}: 1
  // CHECK: parameter 'high' {{.*}} at 31:13
  if (Value > High)
    Message.data = 2;
  Out.publish(Message);
}
