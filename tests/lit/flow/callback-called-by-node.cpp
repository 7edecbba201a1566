// REQUIRES: ros1-headers
// RUN: %compile-real -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A callback that the node calls with a message of its own, too, gets one of
// those or a received one. What it reads is not known to be configured, even if
// the node writes nothing but constants into its own: it is no threshold for a
// limit that is lowered to a measured value.
#include <boost/bind.hpp>
#include <boost/function.hpp>
#include <boost/make_shared.hpp>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Node {
public:
  Node() {
    ros::NodeHandle Handle;
    Handle.param("limit", Limit, 1.0);
    Handle.param("step", Step, 1.0);
    Out = Handle.advertise<std_msgs::Float64>("out", 1);
    In = Handle.subscribe("in", 1, &Node::receive, this);
  }
  void receive(const std_msgs::Float64ConstPtr &Message) {
    Speed = Message->data;
  }
  void stop() {
    auto Message = boost::make_shared<std_msgs::Float64>();
    Message->data = 0;
    boost::function<void(std_msgs::Float64ConstPtr)> F =
        boost::bind(&Node::receive, this, _1);
    F(Message);
  }
  // CHECK: comparisons of {{.*}}: 1
  void run(bool Near) {
    double Most = Limit;
    if (Near)
      Most = ros::Time::now().toSec();
    // CHECK-NEXT: 'limit' relation > {{.*}} at [[#@LINE+1]]:14
    if (Most < Speed + Step)
      Out.publish(std_msgs::Float64());
  }

private:
  double Limit, Step, Speed = 0;
  ros::Publisher Out;
  ros::Subscriber In;
};

int main(int Count, char **Arguments) {
  ros::init(Count, Arguments, "node");
  Node N;
  N.stop();
  N.run(Count > 1);
  ros::spin();
}
