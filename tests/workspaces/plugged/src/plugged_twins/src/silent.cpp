#include <plugged_core/planner.h>
#include <plugged_limits/limit.h>
#include <pluginlib/class_list_macros.hpp>

namespace plugged {
// It compares its parameters, and whatever comes of that is only counted.
class Silent : public Planner {
  void configure(const ros::NodeHandle &handle) override {
    quiet_.read(handle, "quiet_distance", 2.0);
    handle.param("counted_distance", counted_, 3.0);
  }
  bool mayGo(double distance) override {
    if (distance > counted_)
      ++count_;
    if (quiet_.isPassedBy(distance))
      ++count_;
    return false;
  }
  Limit quiet_;
  double counted_ = 0;
  int count_ = 0;
};
} // namespace plugged
PLUGINLIB_EXPORT_CLASS(plugged::Silent, plugged::Planner)
