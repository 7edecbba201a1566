#include <dozen_plugins/filter.h>
#include <pluginlib/class_list_macros.hpp>
#include <std_msgs/Float64.h>

namespace dozen_plugins {
class HighPass : public Filter {
  void start(ros::NodeHandle &handle) override {
    handle.param("pass", pass_, 2.5);
    publisher_ = handle.advertise<std_msgs::Float64>("passed", 1);
  }
  bool offer(double value) override {
    if (value <= pass_) // TPC pass
      return false;
    std_msgs::Float64 message;
    message.data = value;
    publisher_.publish(message);
    return true;
  }
  double pass_ = 0;
  ros::Publisher publisher_;
};
} // namespace dozen_plugins
PLUGINLIB_EXPORT_CLASS(dozen_plugins::HighPass, dozen_plugins::Filter)
