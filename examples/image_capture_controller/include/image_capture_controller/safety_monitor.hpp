#ifndef IMAGE_CAPTURE_CONTROLLER_SAFETY_MONITOR_HPP
#define IMAGE_CAPTURE_CONTROLLER_SAFETY_MONITOR_HPP

#include <geometry_msgs/msg/point.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <rclcpp_lifecycle/lifecycle_publisher.hpp>
#include <std_msgs/msg/string.hpp>

#include <optional>
#include <string>

namespace image_capture_controller {

/// Publishes an alarm where the UAV is outside of its limits.
class SafetyMonitor {
public:
  explicit SafetyMonitor(rclcpp_lifecycle::LifecycleNode &node);

  /// Take in a reading of the battery, V.
  void addVoltage(double voltage);

  /// Raise an alarm where one is due.
  void check(const geometry_msgs::msg::Point &place, const rclcpp::Time &now);

private:
  bool insideFence(const geometry_msgs::msg::Point &place) const;
  void raise(const std::string &text, const rclcpp::Time &now);

  rclcpp::Logger logger_;
  double geofence_radius_;
  double max_height_;
  double battery_abort_voltage_;
  int battery_abort_samples_;
  double battery_warn_voltage_;
  rclcpp::Duration alarm_repeat_period_;
  rclcpp_lifecycle::LifecyclePublisher<std_msgs::msg::String>::SharedPtr
      alarm_pub_;
  std::optional<rclcpp::Time> last_alarm_;
  double voltage_ = 12.0;
  int empty_samples_ = 0;
  int warnings_ = 0;
};

} // namespace image_capture_controller

#endif
