// Ends a flight that leaves its fence, climbs too high or runs out of battery.
#ifndef IMAGE_CAPTURE_SAFETY_MONITOR_H
#define IMAGE_CAPTURE_SAFETY_MONITOR_H

#include <cstdint>
#include <string>

#include <ros/ros.h>

#include "image_capture/filters.h"

namespace image_capture {

/// The measurements that the monitor checks; metres from the start, volts.
struct SafetySample {
  double x = 0.0;
  double y = 0.0;
  double height = 0.0;
  double battery_voltage = 0.0;
};

class SafetyMonitor {
public:
  /// Reads its limits below `private_nh` and advertises /safety/alarm.
  SafetyMonitor(ros::NodeHandle &nh, ros::NodeHandle &private_nh);

  /// False when the flight must end. Repeats the reason on /safety/alarm as
  /// long as it lasts.
  bool check(const SafetySample &sample, const ros::Time &now);

  unsigned lowBatteryWarnings() const { return low_battery_warnings_; }

private:
  bool insideFence(double x, double y) const;
  bool batteryEmpty(double voltage);
  void raise(std::uint8_t kind, const std::string &text, const ros::Time &now);

  ros::Publisher alarm_pub_;
  IirLowPass voltage_filter_{0.1};
  ros::Time last_alarm_;
  double geofence_radius_;
  double max_height_;
  double battery_abort_voltage_;
  double battery_warn_voltage_;
  double alarm_repeat_period_;
  int battery_abort_samples_;
  int empty_samples_ = 0;
  unsigned low_battery_warnings_ = 0;
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_SAFETY_MONITOR_H
