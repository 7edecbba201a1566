#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

namespace dozen_plugins {
class Relay : public nodelet::Nodelet {
  void onInit() override {
    ros::NodeHandle &handle = getPrivateNodeHandle();
    handle.param("least", least_, 1.5);
    publisher_ = handle.advertise<std_msgs::Float64>("out", 1);
    subscriber_ = handle.subscribe("in", 1, &Relay::receive, this);
  }
  void receive(const std_msgs::Float64::ConstPtr &message) {
    if (message->data > least_) // TPC ~least
      publisher_.publish(message);
  }
  double least_ = 0;
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
};
} // namespace dozen_plugins
PLUGINLIB_EXPORT_CLASS(dozen_plugins::Relay, nodelet::Nodelet)
