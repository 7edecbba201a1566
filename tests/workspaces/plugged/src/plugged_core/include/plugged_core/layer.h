#pragma once
#include <ros/ros.h>

namespace plugged {
class Layer {
public:
  virtual ~Layer() = default;
  virtual void configure(const ros::NodeHandle &handle) = 0;
  virtual double cost(double distance) = 0;
};
} // namespace plugged
