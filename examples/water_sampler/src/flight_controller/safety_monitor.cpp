#include "water_sampler/safety_monitor.h"

#include <cmath>

#include <water_sampler/Alarm.h>

namespace water_sampler {

SafetyMonitor::SafetyMonitor(ros::NodeHandle &nh, ros::NodeHandle &private_nh) {
  private_nh.param("geofence_radius", geofence_radius_, 8.0);
  private_nh.param("max_height", max_height_, 4.0);
  private_nh.param("battery_abort_voltage", battery_abort_voltage_, 10.6);
  private_nh.param("battery_abort_samples", battery_abort_samples_, 20);
  private_nh.param("alarm_repeat_period", alarm_repeat_period_, 2.0);
  alarm_pub_ = nh.advertise<Alarm>("/safety/alarm", 10, true);
}

bool SafetyMonitor::check(const Estimate &estimate, double voltage,
                          const ros::Time &now) {
  const bool empty = batteryEmpty(voltage);
  if (std::hypot(estimate.x, estimate.y) > geofence_radius_) {
    raise(Alarm::GEOFENCE, "outside the fence", now);
    return false;
  }
  if (estimate.z > max_height_) {
    raise(Alarm::HEIGHT, "too high", now);
    return false;
  }
  if (empty) {
    raise(Alarm::BATTERY, "battery empty", now);
    return false;
  }
  return true;
}

bool SafetyMonitor::batteryEmpty(double voltage) {
  // A single reading below the limit is the motors' load, not the charge.
  const bool low = voltage_filter_.update(voltage) < battery_abort_voltage_;
  empty_samples_ = low ? empty_samples_ + 1 : 0;
  return empty_samples_ >= battery_abort_samples_;
}

void SafetyMonitor::raise(std::uint8_t kind, const std::string &text,
                          const ros::Time &now) {
  if (!last_alarm_.isZero() &&
      (now - last_alarm_).toSec() < alarm_repeat_period_)
    return;
  last_alarm_ = now;
  Alarm alarm;
  alarm.header.stamp = now;
  alarm.kind = kind;
  alarm.text = text;
  alarm_pub_.publish(alarm);
}

} // namespace water_sampler
