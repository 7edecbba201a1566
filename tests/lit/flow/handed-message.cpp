// REQUIRES: ros1-headers
// RUN: %compile-real -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A library also hands over messages that the node made: an algorithm those of
// a vector, a factory the one that it was given, a thread and a function object
// those that were bound or passed. Those are not received.
#include <algorithm>
#include <boost/bind.hpp>
#include <boost/function.hpp>
#include <boost/make_shared.hpp>
#include <functional>
#include <memory>
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>
#include <thread>

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
    Handle.param("threaded", Threaded, 1.0);
    Handle.param("called", Called, 1.0);
    Handle.param("bound", Bound, 1.0);
    Out = Handle.advertise<std_msgs::Float64>("out", 1);
    Kept.resize(3);
  }
  // CHECK: comparisons of {{.*}}: 5
  // CHECK-DAG: 'gain'{{.*}} at [[# @LINE + 3]]:
  // CHECK-DAG: 'limit'{{.*}} at [[# @LINE + 3]]:
  void run() {
    Kept[0].data = Gain > 2 ? 1 : 0;
    Own.data = Limit > 2 ? 1 : 0;
    std::for_each(Kept.begin(), Kept.end(), relay);
    Last = std::make_shared<Sender>(Out, Own);
  }
  // CHECK-DAG: 'threaded'{{.*}} at [[# @LINE + 3]]:
  void runThread() {
    auto Message = boost::make_shared<std_msgs::Float64>();
    Message->data = Threaded > 2 ? 1 : 0;
    std::thread(&Node::receive, Message).join();
  }
  // CHECK-DAG: 'called'{{.*}} at [[# @LINE + 3]]:
  void runFunction() {
    auto Message = boost::make_shared<std_msgs::Int32>();
    Message->data = Called > 2 ? 1 : 0;
    boost::function<void(std_msgs::Int32ConstPtr)> F =
        boost::bind(&Node::call, this, _1);
    F(Message);
  }
  // CHECK-DAG: 'bound'{{.*}} at [[# @LINE + 3]]:
  void runBound() {
    auto Message = boost::make_shared<std_msgs::Bool>();
    Message->data = Bound > 2;
    std::function<void()> F = std::bind(&Node::see, this, *Message);
    F();
  }
  static void receive(const std_msgs::Float64ConstPtr &Message) {
    if (Message->data > 0)
      Out.publish(std_msgs::Float64());
  }
  void call(const std_msgs::Int32ConstPtr &Message) {
    if (Message->data > 0)
      Out.publish(std_msgs::Float64());
  }
  void see(const std_msgs::Bool &Message) {
    if (Message.data)
      Out.publish(std_msgs::Float64());
  }
  static void relay(const std_msgs::Float64 &Message) {
    if (Message.data > 0)
      Out.publish(std_msgs::Float64());
  }

private:
  double Gain, Limit, Threaded, Called, Bound;
  std::vector<std_msgs::Float64> Kept;
  std_msgs::Float64 Own;
  std::shared_ptr<Sender> Last;
  static ros::Publisher Out;
};
ros::Publisher Node::Out;

int main(int Count, char **Arguments) {
  ros::init(Count, Arguments, "node");
  Node().run();
  Node().runThread();
  Node().runFunction();
  Node().runBound();
}
