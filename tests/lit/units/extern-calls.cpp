// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-extern-calls>' %t.o | FileCheck %s
//
// ExternCallFinder: publish and service call, with the name that a constant
// gave the object, however it got into its variable; calls inside ROS's own
// code do not count.
#include <ros/ros.h>

class Node {
public:
  explicit Node(ros::NodeHandle &Handle, const std::string &Name) {
    Member = Handle.advertise<std_msgs::Number>("member", 1);
    Unknown = Handle.advertise<std_msgs::Number>(Name, 1);
    Client = Handle.serviceClient<std_msgs::Number, std_msgs::Number>("arm");
  }
  // CHECK: exposing statements of {{.*}}: 4
  void step(ros::NodeHandle &Handle) {
    std_msgs::Number A, B;
    // CHECK-DAG: ros::Publisher::publish topic 'member' in {{.*}} at [[#@LINE+1]]:12
    Member.publish(A);
    // CHECK-DAG: ros::Publisher::publish topic '' in {{.*}} at [[#@LINE+1]]:13
    Unknown.publish(A);
    // CHECK-DAG: ros::ServiceClient::call topic 'arm' in {{.*}} at [[#@LINE+1]]:12
    Client.call(A, B);
    ros::Publisher Local = Handle.advertise<std_msgs::Number>("local", 1);
    // CHECK-DAG: ros::Publisher::publish topic 'local' in {{.*}} at [[#@LINE+1]]:11
    Local.publish(A);
  }

private:
  ros::Publisher Member, Unknown;
  ros::ServiceClient Client;
};

void run(ros::NodeHandle &Handle, const std::string &Name) {
  Node(Handle, Name).step(Handle);
}
