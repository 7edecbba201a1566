// REQUIRES: ros1-headers
// RUN: %compile-real -O2 -w %s -o %t.o
// RUN: %opt -disable-output -passes=tpc -tpc-static-info=%t.json %t.o
// RUN: %python %inputs/show.py messages %t.json | FileCheck %s --match-full-lines
//
// The topics on whose messages a comparison depends: by the compared value, also
// through members, or because it is only evaluated when a message arrives or
// has arrived. A topic is named as its handle resolves it.
#include <boost/bind/bind.hpp>
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>

class Node {
public:
  Node() : Own("~") {
    ros::NodeHandle Handle;
    Own.param("far", Far, 1.0);
    Own.param("retry", Retry, 1.0);
    Own.param("age", Age, 1.0);
    Own.param("alone", Alone, 1.0);
    Own.param("most", Most, 1.0);
    Out = Own.advertise<std_msgs::Float64>("out", 1);
    Scan = Handle.subscribe("scan", 1, &Node::scan, this);
    Enable = Own.subscribe("enable", 1, &Node::enable, this);
    Count = Handle.subscribe<std_msgs::Int32>(
        "/count", 1, [this](const std_msgs::Int32::ConstPtr &M) { Got = M->data; });
    Bound = Handle.subscribe<std_msgs::Float64>(
        "bound", 1, boost::bind(&Node::bound, this, boost::placeholders::_1, 3));
    Timer = Handle.createTimer(ros::Duration(1), &Node::step, this);
  }

private:
  void publish(double Value) {
    std_msgs::Float64 Message;
    Message.data = Value;
    Out.publish(Message);
  }
  void scan(const std_msgs::Float64::ConstPtr &Message) {
    Last = ros::Time::now().toSec();
    // CHECK-DAG: ~far: ~out std_msgs/Float64 <- scan std_msgs/Float64 value
    if (Message->data > Far)
      publish(1);
  }
  void bound(const std_msgs::Float64::ConstPtr &Message, double Factor) {
    // CHECK-DAG: ~most: ~out std_msgs/Float64 <- bound std_msgs/Float64 value
    if (Message->data * Factor > Most)
      publish(5);
  }
  void enable(const std_msgs::Bool &Message) { Enabled = Message.data; }
  void step(const ros::TimerEvent &) {
    // CHECK-DAG: ~alone: ~out std_msgs/Float64
    if (ros::Time::now().toSec() > Alone)
      publish(2);
    if (!Enabled)
      return;
    // CHECK-DAG: ~retry: ~out std_msgs/Float64 <- /count std_msgs/Int32 value <- ~enable std_msgs/Bool control
    if (Got > Retry)
      publish(3);
    // CHECK-DAG: ~age: ~out std_msgs/Float64 <- scan std_msgs/Float64 value <- ~enable std_msgs/Bool control
    if (ros::Time::now().toSec() - Last > Age)
      publish(4);
  }

  ros::NodeHandle Own;
  double Far, Retry, Age, Alone, Most, Last = 0;
  int Got = 0;
  bool Enabled = false;
  ros::Publisher Out;
  ros::Subscriber Scan, Enable, Count, Bound;
  ros::Timer Timer;
};

int main(int Argc, char **Argv) {
  ros::init(Argc, Argv, "node");
  Node N;
  ros::spin();
}
