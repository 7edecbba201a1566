// REQUIRES: ros1-headers
// RUN: %compile-real -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A message is published by a smart pointer: what is written through it, also
// in a function that gets it, through a copy of it, and through the pointer that
// a pointer to const was made from, is shown. What is written later is not.
#include <boost/make_shared.hpp>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Node {
public:
  Node() {
    ros::NodeHandle Handle;
    Handle.param("high", High, 1.0);
    Handle.param("inner", Inner, 1.0);
    Handle.param("kept", Kept, 1.0);
    Handle.param("copied", Copied, 1.0);
    Handle.param("before", Before, 1.0);
    Handle.param("late", Late, 1.0);
    Out = Handle.advertise<std_msgs::Float64>("out", 1);
    Last = boost::make_shared<std_msgs::Float64>();
  }
  // CHECK: comparisons of {{.*}}: 5
  void run(double Value) {
    auto Message = boost::make_shared<std_msgs::Float64>();
    // CHECK-DAG: 'high'{{.*}} at [[#@LINE+1]]:
    if (Value > High)
      Message->data = 1;
    fill(*Message, Value);
    Out.publish(Message);
    // CHECK-DAG: 'kept'{{.*}} at [[#@LINE+1]]:
    if (Value > Kept)
      Last->data = 2;
    Out.publish(Last);
  }
  void fill(std_msgs::Float64 &Message, double Value) {
    // CHECK-DAG: 'inner'{{.*}} at [[#@LINE+1]]:
    if (Value > Inner)
      Message.data = 2;
  }

  void runConst(double Value) {
    auto Message = boost::make_shared<std_msgs::Float64>();
    // CHECK-DAG: 'before'{{.*}} at [[#@LINE+1]]:
    if (Value > Before)
      Message->data = 1;
    std_msgs::Float64ConstPtr Shown = Message;
    Out.publish(Shown);
    if (Value > Late)
      Message->data = 2;
  }
  void runCopied(double Value) {
    auto Message = boost::make_shared<std_msgs::Float64>();
    fillCopy(Message, Value);
    Out.publish(Message);
  }
  void fillCopy(std_msgs::Float64Ptr Message, double Value) {
    // CHECK-DAG: 'copied'{{.*}} at [[#@LINE+1]]:
    if (Value > Copied)
      Message->data = 2;
  }

private:
  double High, Inner, Kept, Copied, Before, Late;
  std_msgs::Float64Ptr Last;
  ros::Publisher Out;
};

int main(int Count, char **Arguments) {
  ros::init(Count, Arguments, "node");
  double Value = ros::Time::now().toSec();
  Node().run(Value);
  Node().runConst(Value);
  Node().runCopied(Value);
}
