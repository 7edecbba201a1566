//===- Listener.cpp - One subscriber of the reports' topic
//-----------------===//
#include <ros/ros.h>
#include <std_msgs/String.h>

static void take(const std_msgs::String::ConstPtr &) {}

int main(int Argc, char **Argv) {
  ros::init(Argc, Argv, "listener");
  ros::NodeHandle Node;
  const ros::Subscriber In =
      Node.subscribe("/threshold_information", 10000, take);
  ros::spin();
}
