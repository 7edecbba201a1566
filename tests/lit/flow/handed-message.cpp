// REQUIRES: ros1-headers
// RUN: %compile-real -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A library also hands over messages that the node made: an algorithm those of
// a vector, a factory the one that it was given. Those are not received.
#include <algorithm>
#include <memory>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

struct Sender {
  Sender(ros::Publisher &To, const std_msgs::Float64 &Message) {
    if (Message.data > 0)
      To.publish(std_msgs::Float64());
  }
};

class Node {
public:
  Node() {
    ros::NodeHandle Handle;
    Handle.param("gain", Gain, 1.0);
    Handle.param("limit", Limit, 1.0);
    Out = Handle.advertise<std_msgs::Float64>("out", 1);
    Kept.resize(3);
  }
  // CHECK: comparisons of {{.*}}: 2
  // CHECK-DAG: 'gain'{{.*}} at [[# @LINE + 3]]:
  // CHECK-DAG: 'limit'{{.*}} at [[# @LINE + 3]]:
  void run() {
    Kept[0].data = Gain > 2 ? 1 : 0;
    Own.data = Limit > 2 ? 1 : 0;
    std::for_each(Kept.begin(), Kept.end(), relay);
    Last = std::make_shared<Sender>(Out, Own);
  }
  static void relay(const std_msgs::Float64 &Message) {
    if (Message.data > 0)
      Out.publish(std_msgs::Float64());
  }

private:
  double Gain, Limit;
  std::vector<std_msgs::Float64> Kept;
  std_msgs::Float64 Own;
  std::shared_ptr<Sender> Last;
  static ros::Publisher Out;
};
ros::Publisher Node::Out;

int main(int Count, char **Arguments) {
  ros::init(Count, Arguments, "node");
  Node().run();
}
