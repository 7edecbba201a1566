#pragma once
#include <ros/ros.h>
#include <string>

namespace plugged {
/// A parameter, and the question whether a value is above it.
class Limit {
public:
  void read(const ros::NodeHandle &handle, const std::string &name, double usual);
  bool isPassedBy(double value) const;

private:
  double limit_ = 0;
};
} // namespace plugged
