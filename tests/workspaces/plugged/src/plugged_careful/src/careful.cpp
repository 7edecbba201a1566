#include <plugged_core/planner.h>
#include <plugged_limits/limit.h>
#include <plugged_map/map.h>
#include <pluginlib/class_list_macros.hpp>

namespace plugged {
class Careful : public Planner {
  void configure(const ros::NodeHandle &handle) override {
    slow_.read(handle, "slow_distance", 1.0);
    map_.configure(handle);
  }
  bool mayGo(double distance) override {
    return slow_.isPassedBy(distance) && !map_.isBlocked(distance);
  }
  Limit slow_;
  Map map_;
};
} // namespace plugged
PLUGINLIB_EXPORT_CLASS(plugged::Careful, plugged::Planner)
