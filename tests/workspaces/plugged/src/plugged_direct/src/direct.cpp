#include <plugged_core/planner.h>
#include <pluginlib/class_list_macros.hpp>

namespace plugged {
class Direct : public Planner {
  void configure(const ros::NodeHandle &handle) override {
    handle.param("stop_distance", stop_, 0.3);
  }
  bool mayGo(double distance) override {
    return distance > stop_; // TPC stop_distance
  }
  double stop_ = 0;
};
} // namespace plugged
PLUGINLIB_EXPORT_CLASS(plugged::Direct, plugged::Planner)
