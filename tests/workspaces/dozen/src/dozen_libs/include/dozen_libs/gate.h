#pragma once
#include <ros/ros.h>

double clamped(double value, double most);

/// Lets values through that are no less than the parameter gate/level.
class Gate {
public:
  explicit Gate(ros::NodeHandle &handle);
  void offer(double value);

private:
  double level_;
  ros::Publisher publisher_;
};
