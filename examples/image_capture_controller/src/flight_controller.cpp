#include "image_capture_controller/flight_controller.hpp"

#include <rclcpp_components/register_node_macro.hpp>

#include <cmath>

namespace image_capture_controller {

namespace {

constexpr double POSITION_GAIN = 1.0;
constexpr double HEIGHT_GAIN = 1.2;
constexpr double YAW_GAIN = 1.5;
constexpr double TURN = 2.0 * M_PI;

double wrapAngle(double angle) { return std::remainder(angle, TURN); }

/// The heading of an upright pose, rad.
double yawOf(const geometry_msgs::msg::Pose &pose) {
  return wrapAngle(2.0 * std::atan2(pose.orientation.z, pose.orientation.w));
}

} // namespace

FlightController::FlightController(const rclcpp::NodeOptions &options)
    : LifecycleNode("flight_controller", options) {
  declare_parameter("cruise_speed", 1.0);
  declare_parameter("max_velocity", 1.5);
  declare_parameter("max_climb_rate", 0.8);
  declare_parameter("max_yaw_rate", 1.0);
  declare_parameter("setpoint_timeout", 1.5);
}

FlightController::CallbackReturn
FlightController::on_configure(const rclcpp_lifecycle::State &) {
  get_parameter("cruise_speed", cruise_speed_);
  get_parameter("max_velocity", max_velocity_);
  max_climb_rate_ = get_parameter("max_climb_rate").as_double();
  max_yaw_rate_ = get_parameter("max_yaw_rate").as_double();
  setpoint_timeout_ = rclcpp::Duration::from_seconds(
      get_parameter("setpoint_timeout").as_double());
  safety_ = std::make_unique<SafetyMonitor>(*this);
  command_pub_ = create_publisher<TwistStamped>("/uav/command", 10);
  state_pub_ = create_publisher<Odometry>("/controller/state", 10);
  setpoint_sub_ = create_subscription<PoseStamped>(
      "/mission/setpoint", 10,
      [this](const PoseStamped &setpoint) { onSetpoint(setpoint); });
  battery_sub_ = create_subscription<sensor_msgs::msg::BatteryState>(
      "/uav/battery", 10,
      [this](const sensor_msgs::msg::BatteryState &battery) {
        safety_->addVoltage(battery.voltage);
      });
  pose_sub_ = create_subscription<PoseStamped>(
      "/uav/pose", 10, [this](const PoseStamped &pose) { onPose(pose); });
  on_set_ = add_on_set_parameters_callback(
      [this](const std::vector<rclcpp::Parameter> &parameters) {
        return onSet(parameters);
      });
  return CallbackReturn::SUCCESS;
}

FlightController::CallbackReturn
FlightController::on_cleanup(const rclcpp_lifecycle::State &) {
  on_set_.reset();
  pose_sub_.reset();
  battery_sub_.reset();
  setpoint_sub_.reset();
  state_pub_.reset();
  command_pub_.reset();
  safety_.reset();
  setpoint_.reset();
  last_.reset();
  return CallbackReturn::SUCCESS;
}

rcl_interfaces::msg::SetParametersResult
FlightController::onSet(const std::vector<rclcpp::Parameter> &parameters) {
  rcl_interfaces::msg::SetParametersResult result;
  result.successful = true;
  for (const rclcpp::Parameter &parameter : parameters) {
    if (parameter.get_name() == "cruise_speed")
      cruise_speed_ = parameter.as_double();
    else if (parameter.get_name() == "max_velocity")
      max_velocity_ = parameter.as_double();
  }
  return result;
}

void FlightController::onSetpoint(const PoseStamped &setpoint) {
  setpoint_ = setpoint;
}

void FlightController::onPose(const PoseStamped &pose) {
  const rclcpp::Time now(pose.header.stamp);
  safety_->check(pose.pose.position, now);
  TwistStamped command;
  command.header = pose.header;
  if (setpoint_ && fresh(*setpoint_, now)) {
    advance(*setpoint_, last_ ? (now - *last_).seconds() : 0.0);
    steer(command, pose, *setpoint_);
  }
  last_ = now;
  command_pub_->publish(command);
  Odometry state;
  state.header = pose.header;
  state.pose.pose = pose.pose;
  state.twist.twist = command.twist;
  state_pub_->publish(state);
}

bool FlightController::fresh(const PoseStamped &setpoint,
                             const rclcpp::Time &now) const {
  return now - rclcpp::Time(setpoint.header.stamp) < setpoint_timeout_;
}

/// Move the point that it flies to, as fast as it is to travel.
void FlightController::advance(const PoseStamped &setpoint, double seconds) {
  const double dx = setpoint.pose.position.x - x_;
  const double dy = setpoint.pose.position.y - y_;
  const double distance = std::hypot(dx, dy);
  const double step = cruise_speed_ * seconds;
  const double share = distance > step ? step / distance : 1.0;
  x_ += share * dx;
  y_ += share * dy;
}

void FlightController::steer(TwistStamped &command, const PoseStamped &pose,
                             const PoseStamped &setpoint) const {
  const geometry_msgs::msg::Point &place = pose.pose.position;
  double vx = POSITION_GAIN * (x_ - place.x);
  double vy = POSITION_GAIN * (y_ - place.y);
  const double speed = std::hypot(vx, vy);
  if (speed > max_velocity_) {
    vx *= max_velocity_ / speed;
    vy *= max_velocity_ / speed;
  }
  command.twist.linear.x = vx;
  command.twist.linear.y = vy;
  command.twist.linear.z = climbRate(setpoint.pose.position.z - place.z);
  command.twist.angular.z = yawRate(yawOf(setpoint.pose) - yawOf(pose.pose));
}

double FlightController::climbRate(double error) const {
  const double rate = HEIGHT_GAIN * error;
  if (std::abs(rate) > max_climb_rate_)
    return std::copysign(max_climb_rate_, rate);
  return rate;
}

double FlightController::yawRate(double error) const {
  const double rate = YAW_GAIN * wrapAngle(error);
  if (std::abs(rate) > max_yaw_rate_)
    return std::copysign(max_yaw_rate_, rate);
  return rate;
}

} // namespace image_capture_controller

RCLCPP_COMPONENTS_REGISTER_NODE(image_capture_controller::FlightController)
