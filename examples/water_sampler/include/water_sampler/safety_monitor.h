// Ends a flight that leaves its fence, climbs too high or runs out of battery.
#ifndef WATER_SAMPLER_SAFETY_MONITOR_H
#define WATER_SAMPLER_SAFETY_MONITOR_H

#include <cstdint>
#include <string>

#include <ros/ros.h>

#include "water_sampler/filters.h"
#include "water_sampler/state_estimator.h"

namespace water_sampler {

class SafetyMonitor {
public:
  /// Reads its limits below `private_nh` and advertises /safety/alarm.
  SafetyMonitor(ros::NodeHandle &nh, ros::NodeHandle &private_nh);

  /// False when the flight must end. Repeats the reason on /safety/alarm as
  /// long as it lasts.
  bool check(const Estimate &estimate, double voltage, const ros::Time &now);

private:
  bool batteryEmpty(double voltage);
  void raise(std::uint8_t kind, const std::string &text, const ros::Time &now);

  ros::Publisher alarm_pub_;
  LowPass voltage_filter_{0.1};
  ros::Time last_alarm_;
  double geofence_radius_;
  double max_height_;
  double battery_abort_voltage_;
  double alarm_repeat_period_;
  int battery_abort_samples_;
  int empty_samples_ = 0;
};

} // namespace water_sampler

#endif // WATER_SAMPLER_SAFETY_MONITOR_H
