#pragma once
#include <ros/ros.h>

namespace plugged {
class Planner {
public:
  virtual ~Planner() = default;
  virtual void configure(const ros::NodeHandle &handle) = 0;
  virtual bool mayGo(double distance) = 0;
};
} // namespace plugged
