#include <plugged_core/layer.h>
#include <pluginlib/class_list_macros.hpp>

namespace plugged {
class Floor : public Layer {
  void configure(const ros::NodeHandle &handle) override {
    handle.param("floor_cost", cost_, 10.0);
  }
  double cost(double) override { return cost_; }
  double cost_ = 0;
};
} // namespace plugged
PLUGINLIB_EXPORT_CLASS(plugged::Floor, plugged::Layer)
