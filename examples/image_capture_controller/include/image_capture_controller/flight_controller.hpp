#ifndef IMAGE_CAPTURE_CONTROLLER_FLIGHT_CONTROLLER_HPP
#define IMAGE_CAPTURE_CONTROLLER_FLIGHT_CONTROLLER_HPP

#include "image_capture_controller/safety_monitor.hpp"

#include <geometry_msgs/msg/pose_stamped.hpp>
#include <geometry_msgs/msg/twist_stamped.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <rclcpp_lifecycle/lifecycle_publisher.hpp>
#include <sensor_msgs/msg/battery_state.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace image_capture_controller {

/// Answers each measured pose with velocities that lead to the setpoint.
class FlightController : public rclcpp_lifecycle::LifecycleNode {
public:
  using CallbackReturn =
      rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;

  explicit FlightController(const rclcpp::NodeOptions &options);

  CallbackReturn on_configure(const rclcpp_lifecycle::State &state) override;
  CallbackReturn on_cleanup(const rclcpp_lifecycle::State &state) override;

private:
  using PoseStamped = geometry_msgs::msg::PoseStamped;
  using TwistStamped = geometry_msgs::msg::TwistStamped;
  using Odometry = nav_msgs::msg::Odometry;

  rcl_interfaces::msg::SetParametersResult
  onSet(const std::vector<rclcpp::Parameter> &parameters);
  void onSetpoint(const PoseStamped &setpoint);
  void onPose(const PoseStamped &pose);

  bool fresh(const PoseStamped &setpoint, const rclcpp::Time &now) const;
  void advance(const PoseStamped &setpoint, double seconds);
  void steer(TwistStamped &command, const PoseStamped &pose,
             const PoseStamped &setpoint) const;
  double climbRate(double error) const;
  double yawRate(double error) const;

  double cruise_speed_ = 0.0;
  double max_velocity_ = 0.0;
  double max_climb_rate_ = 0.0;
  double max_yaw_rate_ = 0.0;
  rclcpp::Duration setpoint_timeout_{0, 0};

  std::unique_ptr<SafetyMonitor> safety_;
  std::optional<PoseStamped> setpoint_;
  double x_ = 0.0;
  double y_ = 0.0;
  std::optional<rclcpp::Time> last_;

  rclcpp_lifecycle::LifecyclePublisher<TwistStamped>::SharedPtr command_pub_;
  rclcpp_lifecycle::LifecyclePublisher<Odometry>::SharedPtr state_pub_;
  rclcpp::Subscription<PoseStamped>::SharedPtr setpoint_sub_;
  rclcpp::Subscription<PoseStamped>::SharedPtr pose_sub_;
  rclcpp::Subscription<sensor_msgs::msg::BatteryState>::SharedPtr battery_sub_;
  OnSetParametersCallbackHandle::SharedPtr on_set_;
};

} // namespace image_capture_controller

#endif
