#include <algorithm>
#include <plugged_map/map.h>

namespace plugged {
Map::Map() : loader_("plugged_core", "plugged::Layer") {}

void Map::configure(const ros::NodeHandle &handle) {
  std::vector<std::string> names;
  handle.getParam("layers", names);
  handle.param("lethal_cost", lethal_, 200.0);
  for (const std::string &name : names) {
    layers_.push_back(loader_.createInstance(name));
    layers_.back()->configure(handle);
  }
}

bool Map::isBlocked(double distance) {
  double cost = 0;
  for (auto &layer : layers_)
    cost = std::max(cost, layer->cost(distance));
  return cost >= lethal_; // TPC lethal_cost
}
} // namespace plugged
