// REQUIRES: ros1-headers
// RUN: %compile-real -O2 -w %s -o %t.o
// RUN: %opt -disable-output -passes=tpc -tpc-static-info=%t.json %t.o
// RUN: %python %inputs/show.py messages %t.json | FileCheck %s --match-full-lines
//
// A filter of messages, and a synchronizer, call back with the messages of the
// only subscription to their type. Of two of one type, nothing is known.
#include <boost/bind/bind.hpp>
#include <message_filters/subscriber.h>
#include <message_filters/time_synchronizer.h>
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>

class Node {
public:
  Node() : Scan(Handle, "scan", 10), A(Handle, "a", 10), B(Handle, "b", 10) {
    ros::NodeHandle Own("~");
    Own.param("far", Far, 1.0);
    Own.param("full", Full, 1.0);
    Own.param("either", Either, 1.0);
    Count.subscribe(Handle, "count", 1);
    Out = Handle.advertise<std_msgs::Float64>("out", 1);
    Scan.registerCallback(
        boost::bind(&Node::scan, this, boost::placeholders::_1));
    Count.registerCallback(&Node::count, this);
    A.registerCallback(&Node::either, this);
  }

private:
  void publish(double Value) {
    std_msgs::Float64 Message;
    Message.data = Value;
    Out.publish(Message);
  }
  void scan(const std_msgs::Float64::ConstPtr &Message) {
    // CHECK-DAG: ~far: out std_msgs/Float64 <- scan std_msgs/Float64 value
    if (Message->data > Far)
      publish(1);
  }
  void count(const std_msgs::Int32::ConstPtr &Message) {
    // CHECK-DAG: ~full: out std_msgs/Float64 <- count std_msgs/Int32 value
    if (Message->data > Full)
      publish(2);
  }
  void either(const std_msgs::Bool::ConstPtr &Message) {
    // CHECK-DAG: ~either: out std_msgs/Float64
    if (Message->data > Either)
      publish(3);
  }

  ros::NodeHandle Handle;
  message_filters::Subscriber<std_msgs::Float64> Scan;
  message_filters::Subscriber<std_msgs::Bool> A, B;
  message_filters::Subscriber<std_msgs::Int32> Count;
  double Far, Full, Either;
  ros::Publisher Out;
};

int main(int Argc, char **Argv) {
  ros::init(Argc, Argv, "node");
  Node N;
  ros::spin();
}
