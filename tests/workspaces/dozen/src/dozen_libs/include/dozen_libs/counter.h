#pragma once
#include <ros/ros.h>
#include <std_msgs/Int32.h>

/// A header's own code: publishes every so many calls.
class Counter {
public:
  explicit Counter(ros::NodeHandle &handle)
      : publisher_(handle.advertise<std_msgs::Int32>("count", 1)) {
    handle.param("count/every", every_, 2);
  }
  void count() {
    if (++count_ >= every_) { // TPC count/every
      std_msgs::Int32 message;
      message.data = count_;
      publisher_.publish(message);
      count_ = 0;
    }
  }

private:
  int every_ = 1;
  int count_ = 0;
  ros::Publisher publisher_;
};
