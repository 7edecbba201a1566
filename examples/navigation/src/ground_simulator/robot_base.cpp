#include "navigation/robot_base.h"

#include <cmath>

namespace navigation {

namespace {
constexpr double FullVoltage = 12.6;
constexpr double EmptyVoltage = 10.0;
constexpr double MotorLag = 0.15;     // s
constexpr double HalfTrack = 0.16;    // m, from the middle to a wheel
constexpr double OdometryBias = 1.02; // the wheels are smaller than they say

double lag(double value, double target, double interval) {
  return value + (target - value) * (1.0 - std::exp(-interval / MotorLag));
}
} // namespace

RobotBase::RobotBase(ros::NodeHandle &private_nh, std::uint32_t seed)
    : noise_(seed) {
  private_nh.param("battery_seconds", battery_seconds_, 400.0);
  private_nh.param("battery_empty_voltage", battery_empty_voltage_, 10.2);
  private_nh.param("max_wheel_speed", max_wheel_speed_, 0.9);
  private_nh.param("enable_slip", enable_slip_, true);
}

void RobotBase::step(const geometry_msgs::Twist &command, const Arena &arena,
                     double interval) {
  double speed = empty_ ? 0.0 : command.linear.x;
  double turn = empty_ ? 0.0 : command.angular.z;
  // The faster wheel runs at its maximum, the other in proportion.
  const double wheel = std::fabs(speed) + HalfTrack * std::fabs(turn);
  if (wheel > max_wheel_speed_) {
    speed *= max_wheel_speed_ / wheel;
    turn *= max_wheel_speed_ / wheel;
  }
  speed_ = lag(speed_, speed, interval);
  turn_rate_ = lag(turn_rate_, turn, interval);
  count(interval);
  slip_.step(noise_, interval);
  turn_slip_.step(noise_, interval);
  sway_.step(noise_, interval);
  const double grip = enable_slip_ ? 1.0 - std::fabs(slip_.value()) : 1.0;
  const double turned = enable_slip_ ? 1.0 + turn_slip_.value() : 1.0;
  Pose next = pose_;
  next.yaw = wrapAngle(pose_.yaw + turned * turn_rate_ * interval);
  next.x += grip * speed_ * std::cos(next.yaw) * interval;
  next.y += grip * speed_ * std::sin(next.yaw) * interval;
  const bool blocked = arena.touches({next.x, next.y});
  if (blocked) {
    // It can turn and back off: only motion further into the obstacle is stopped.
    next.x = pose_.x;
    next.y = pose_.y;
  }
  contact_ = blocked;
  pose_ = next;
  const double load = std::fabs(speed_) + 0.2 * std::fabs(turn_rate_);
  charge_ -= (0.4 + load) * interval / battery_seconds_;
}

void RobotBase::count(double interval) {
  counted_.yaw = wrapAngle(counted_.yaw + turn_rate_ * interval);
  const double way = OdometryBias * speed_ * interval;
  counted_.x += way * std::cos(counted_.yaw);
  counted_.y += way * std::sin(counted_.yaw);
}

double RobotBase::voltage() const {
  const double sag = 0.25 * std::fabs(speed_);
  return EmptyVoltage + (FullVoltage - EmptyVoltage) * charge_ - sag;
}

nav_msgs::Odometry RobotBase::odometry(const ros::Time &stamp) {
  nav_msgs::Odometry odometry;
  odometry.header.stamp = stamp;
  odometry.header.frame_id = "odom";
  odometry.child_frame_id = "base";
  odometry.pose.pose.position.x = counted_.x;
  odometry.pose.pose.position.y = counted_.y;
  odometry.pose.pose.orientation.z = std::sin(0.5 * counted_.yaw);
  odometry.pose.pose.orientation.w = std::cos(0.5 * counted_.yaw);
  odometry.twist.twist.linear.x = speed_ + noise_.gaussian(0.006);
  odometry.twist.twist.angular.z = turn_rate_ + noise_.gaussian(0.01);
  return odometry;
}

RobotStatus RobotBase::status(const ros::Time &stamp) {
  empty_ = voltage() < battery_empty_voltage_;
  RobotStatus status;
  status.header.stamp = stamp;
  status.voltage = voltage() + noise_.gaussian(0.02);
  status.pitch = sway_.value() + noise_.gaussian(0.004);
  status.bumper = contact_;
  return status;
}

} // namespace navigation
