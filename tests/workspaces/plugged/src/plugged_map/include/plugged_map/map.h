#pragma once
#include <memory>
#include <plugged_core/layer.h>
#include <pluginlib/class_loader.hpp>
#include <vector>

namespace plugged {
class Map {
public:
  Map();
  /// Loads the layers that the parameter `layers` names.
  void configure(const ros::NodeHandle &handle);
  bool isBlocked(double distance);

private:
  pluginlib::ClassLoader<Layer> loader_;
  std::vector<boost::shared_ptr<Layer>> layers_;
  double lethal_ = 0;
};
} // namespace plugged
