#include "battery.h"

void Battery::update(double voltage) {
  if (voltage < limits_.critical) {
    state_ = BatteryState::Critical;
    return;
  }
  low_samples_ = voltage < limits_.low ? low_samples_ + 1 : 0;
  state_ =
      low_samples_ >= limits_.samples ? BatteryState::Low : BatteryState::Good;
}

BatteryLimits readLimits(const ros::NodeHandle &nh) {
  BatteryLimits limits;
  nh.param("low", limits.low, 2.0);
  nh.param("critical", limits.critical, -6.0);
  nh.param("samples", limits.samples, 2);
  return limits;
}
