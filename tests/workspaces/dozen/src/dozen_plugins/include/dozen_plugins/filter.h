#pragma once
#include <ros/node_handle.h>

namespace dozen_plugins {
class Filter {
public:
  virtual ~Filter() = default;
  virtual void start(ros::NodeHandle &handle) = 0;
  virtual bool offer(double value) = 0;
};
} // namespace dozen_plugins
