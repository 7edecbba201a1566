#include <plugged_core/layer.h>
#include <pluginlib/class_list_macros.hpp>

namespace plugged {
class Inflation : public Layer {
  void configure(const ros::NodeHandle &handle) override {
    handle.param("inflation_radius", radius_, 0.5);
  }
  double cost(double distance) override {
    if (distance < radius_) // TPC inflation_radius
      return 254;
    return 0;
  }
  double radius_ = 0;
};
} // namespace plugged
PLUGINLIB_EXPORT_CLASS(plugged::Inflation, plugged::Layer)
