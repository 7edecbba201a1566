// REQUIRES: ros1-headers
// RUN: %compile-real -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// The message that a callback gets is none of those that the node fills, even
// if both have the same class and the node's own one is known by its class
// alone. What the callback itself writes into a message that it may change is
// in that message.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

struct Filter {
  std_msgs::Float64 Kept;
  std_msgs::Float64 &kept() { return Kept; }
};

class Node {
public:
  Node() {
    ros::NodeHandle Handle;
    Handle.param("limit", Limit, 1.0);
    Handle.param("gain", Gain, 1.0);
    Out = Handle.advertise<std_msgs::Float64>("out", 1);
    In = Handle.subscribe("in", 1, &Node::receive, this);
    Bound = Handle.subscribe<std_msgs::Float64>(
        "bound", 1, [this](const std_msgs::Float64::ConstPtr &M) { relay(*M); });
    Mutable = Handle.subscribe("mutable", 1, &Node::change, this);
  }
  // CHECK: comparisons of {{.*}}: 1
  // CHECK-NEXT: 'limit'{{.*}}change{{.*}} at [[#@LINE + 5]]:
  void fill(Filter &To) {
    To.kept().data = Gain > 2 ? 1 : 0; // only the node's own message
  }
  void change(const boost::shared_ptr<std_msgs::Float64> &Message) {
    if (ros::Time::now().toSec() > Limit)
      Message->data = 1;
    Out.publish(Message);
  }
  void receive(const std_msgs::Float64::ConstPtr &Message) { relay(*Message); }
  void relay(const std_msgs::Float64 &Message) {
    if (Message.data > 0)
      Out.publish(Message);
  }
  Filter Own;

private:
  double Limit, Gain;
  ros::Publisher Out;
  ros::Subscriber In, Bound, Mutable;
};

int main(int Count, char **Arguments) {
  ros::init(Count, Arguments, "node");
  Node N;
  N.fill(N.Own);
  ros::spin();
}
