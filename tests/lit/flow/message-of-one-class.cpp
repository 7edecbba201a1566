// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A parameter that is sent in a message is not confused with the contents of a
// received message of the same class.
#include <ros/ros.h>

class Node {
public:
  explicit Node(ros::NodeHandle &Handle) { Handle.param("speed", Speed, 1.0); }
  void send() {
    std_msgs::Number Message;
    Message.data = Speed;
    Out.publish(Message);
  }
  // CHECK: comparisons of {{.*}}: 0
  void receive(const std_msgs::Number &In) {
    if (In.data > 5)
      Out.publish(std_msgs::Number());
  }

private:
  double Speed;
  ros::Publisher Out;
};

void run(ros::NodeHandle &Handle, const std_msgs::Number &In) {
  Node N(Handle);
  N.send();
  N.receive(In);
}
