#include "image_capture_controller/safety_monitor.hpp"

#include <cmath>

namespace image_capture_controller {

SafetyMonitor::SafetyMonitor(rclcpp_lifecycle::LifecycleNode &node)
    : logger_(node.get_logger()),
      geofence_radius_(node.declare_parameter("geofence_radius", 12.0)),
      max_height_(node.declare_parameter("max_height", 4.0)),
      battery_abort_voltage_(
          node.declare_parameter("battery_abort_voltage", 10.6)),
      battery_abort_samples_(static_cast<int>(
          node.declare_parameter("battery_abort_samples", 20))),
      battery_warn_voltage_(
          node.declare_parameter("battery_warn_voltage", 11.0)),
      alarm_repeat_period_(rclcpp::Duration::from_seconds(
          node.declare_parameter("alarm_repeat_period", 2.0))),
      alarm_pub_(
          node.create_publisher<std_msgs::msg::String>("/safety/alarm", 10)) {}

void SafetyMonitor::addVoltage(double voltage) {
  voltage_ += 0.3 * (voltage - voltage_);
  if (voltage_ < battery_warn_voltage_) {
    ++warnings_;
    RCLCPP_WARN(logger_, "%d low readings of the battery", warnings_);
  }
  // A single reading below the limit is the motors' load, not the charge.
  if (voltage_ < battery_abort_voltage_)
    ++empty_samples_;
  else
    empty_samples_ = 0;
}

void SafetyMonitor::check(const geometry_msgs::msg::Point &place,
                          const rclcpp::Time &now) {
  if (!insideFence(place))
    raise("outside the fence", now);
  else if (place.z > max_height_)
    raise("too high", now);
  else if (empty_samples_ >= battery_abort_samples_)
    raise("battery empty", now);
}

bool SafetyMonitor::insideFence(const geometry_msgs::msg::Point &place) const {
  return std::hypot(place.x, place.y) <= geofence_radius_;
}

void SafetyMonitor::raise(const std::string &text, const rclcpp::Time &now) {
  if (last_alarm_ && now - *last_alarm_ < alarm_repeat_period_)
    return;
  last_alarm_ = now;
  std_msgs::msg::String alarm;
  alarm.data = text;
  alarm_pub_->publish(alarm);
}

} // namespace image_capture_controller
