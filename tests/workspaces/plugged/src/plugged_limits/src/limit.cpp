#include <plugged_limits/limit.h>

namespace plugged {
void Limit::read(const ros::NodeHandle &handle, const std::string &name, double usual) {
  handle.param(name, limit_, usual);
}

// Of the planner Careful and of the nodelet; Silent asks, too, but nothing comes of that.
bool Limit::isPassedBy(double value) const {
  return value > limit_; // TPC slow_distance, alarm_level
}
} // namespace plugged
