#pragma once
#include <ros/ros.h>

/// Publishes twice what it is given, as long as that is no more than the parameter most.
class Doubler {
public:
  explicit Doubler(double most) : most_(most) {}
  void connect(ros::NodeHandle &handle);
  static double twice(double value) { return 2 * value; }
  bool offer(double value);

private:
  double most_;
  ros::Publisher publisher_;
};
