#pragma once
#include <ros/ros.h>

/// Publishes when what it is told is hotter than the parameter alarm/heat.
class Alarm {
public:
  explicit Alarm(ros::NodeHandle &handle);
  void heat(double degrees);

private:
  double heat_ = 0;
  ros::Publisher publisher_;
};
