#include "navigation/safety_node.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <navigation/SafetyStatus.h>

namespace navigation {

namespace {
constexpr double Degree = M_PI / 180.0;
constexpr double FrontHalf = 45.0 * Degree; // of the sector that is looked at
constexpr double SideFrom = 60.0 * Degree;
constexpr double SideTo = 100.0 * Degree;
constexpr double RearFrom = 148.0 * Degree;
constexpr double VoltageShare = 0.1; // of a new reading in the smoothed one

/// The second smallest range between two angles on either side, m: a single one
/// may be dust.
double clearance(const sensor_msgs::LaserScan &scan, double from, double to) {
  double least = std::numeric_limits<double>::infinity(), second = least;
  for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam) {
    const double angle =
        scan.angle_min + static_cast<double>(beam) * scan.angle_increment;
    if (std::fabs(angle) < from || std::fabs(angle) > to)
      continue;
    const double range = scan.ranges[beam];
    second = std::min(second, std::max(least, range));
    least = std::min(least, range);
  }
  return second;
}
} // namespace

SafetyNode::SafetyNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh) {
  private_nh.param("stop_distance", stop_distance_, 0.4);
  private_nh.param("release_distance", release_distance_, 0.5);
  private_nh.param("slow_distance", slow_distance_, 0.65);
  private_nh.param("slow_share", slow_share_, 0.6);
  private_nh.param("side_distance", side_distance_, 0.28);
  private_nh.param("side_share", side_share_, 0.5);
  private_nh.param("rear_distance", rear_distance_, 0.3);
  private_nh.param("scan_timeout", scan_timeout_, 0.5);
  private_nh.param("status_timeout", status_timeout_, 1.0);
  private_nh.param("command_timeout", command_timeout_, 0.6);
  private_nh.param("bumper_hold", bumper_hold_, 0.4);
  private_nh.param("min_voltage", min_voltage_, 10.6);
  private_nh.param("weak_samples", weak_samples_, 15);
  private_nh.param("tilt_samples", tilt_samples_, 5);
  private_nh.param("enable_front_guard", enable_front_guard_, true);
  double max_tilt_deg;
  private_nh.param("max_tilt_deg", max_tilt_deg, 8.0);
  max_tilt_ = max_tilt_deg * Degree;
  command_pub_ =
      nh.advertise<geometry_msgs::TwistStamped>("/robot/cmd_vel", 10);
  status_pub_ = nh.advertise<SafetyStatus>("/safety/status", 10);
  const auto hints = ros::TransportHints().tcpNoDelay();
  scan_sub_ = nh.subscribe("/scan", 10, &SafetyNode::onScan, this, hints);
  status_sub_ =
      nh.subscribe("/robot/status", 10, &SafetyNode::onStatus, this, hints);
  command_sub_ = nh.subscribe("/recovery/cmd_vel", 10, &SafetyNode::onCommand,
                              this, hints);
  housekeeping_timer_ =
      nh.createTimer(ros::Duration(0.5), &SafetyNode::onHousekeeping, this);
}

void SafetyNode::onStatus(const RobotStatus &status) {
  status_ = status;
  if (status.bumper)
    touched_ = status.header.stamp;
  if (voltage_ == 0.0)
    voltage_ = status.voltage;
  voltage_ += VoltageShare * (status.voltage - voltage_);
  // A single reading below the limit is the motors' load, not the charge.
  weak_ = voltage_ < min_voltage_ ? weak_ + 1 : 0;
  tilted_ = std::fabs(status.pitch) > max_tilt_ ? tilted_ + 1 : 0;
}

void SafetyNode::onScan(const sensor_msgs::LaserScan &scan) {
  scan_ = scan;
  front_ = clearance(scan, 0.0, FrontHalf);
  side_ = clearance(scan, SideFrom, SideTo);
  rear_ = clearance(scan, RearFrom, M_PI);
  takeIn();
}

void SafetyNode::onCommand(const geometry_msgs::TwistStamped &command) {
  command_ = command;
  command_pending_ = true;
  takeIn();
}

void SafetyNode::takeIn() {
  // The scan that the command is based on comes by another connection.
  if (!command_pending_ || scan_.header.stamp < command_.header.stamp)
    return;
  command_pending_ = false;
  geometry_msgs::Twist twist = command_.twist;
  reason_ = reasonToStand(command_.header.stamp);
  if (!reason_.empty()) {
    twist = geometry_msgs::Twist();
  } else {
    if (enable_front_guard_)
      guardFront(twist);
    guardRear(twist);
  }
  publish(command_.header.stamp, twist);
}

std::string SafetyNode::reasonToStand(const ros::Time &now) {
  if ((now - scan_.header.stamp).toSec() > scan_timeout_)
    return "the laser is silent";
  if ((now - status_.header.stamp).toSec() > status_timeout_)
    return "the base is silent";
  if (weak_ >= weak_samples_)
    return "the battery is empty";
  if (tilted_ >= tilt_samples_)
    return "it tilts";
  return "";
}

void SafetyNode::guardFront(geometry_msgs::Twist &twist) {
  if (front_ < stop_distance_)
    blocked_ = true;
  else if (front_ > release_distance_)
    blocked_ = false;
  if (twist.linear.x <= 0.0)
    return;
  const bool touched =
      !touched_.isZero() &&
      (command_.header.stamp - touched_).toSec() < bumper_hold_;
  if (blocked_ || touched) {
    twist.linear.x = 0.0;
    reason_ = blocked_ ? "something is near" : "something was touched";
    return;
  }
  if (front_ < slow_distance_)
    twist.linear.x *= slow_share_;
  if (side_ < side_distance_)
    twist.linear.x *= side_share_;
}

void SafetyNode::guardRear(geometry_msgs::Twist &twist) const {
  if (twist.linear.x < 0.0 && rear_ < rear_distance_)
    twist.linear.x = 0.0;
}

void SafetyNode::onHousekeeping(const ros::TimerEvent &event) {
  if (command_.header.stamp.isZero())
    return;
  const double age = (event.current_real - command_.header.stamp).toSec();
  if (age > command_timeout_) {
    reason_ = "nobody drives";
    publish(event.current_real, geometry_msgs::Twist());
  }
}

void SafetyNode::publish(const ros::Time &stamp,
                         const geometry_msgs::Twist &twist) {
  geometry_msgs::TwistStamped command;
  command.header.stamp = stamp;
  command.twist = twist;
  command_pub_.publish(command);
  SafetyStatus status;
  status.header.stamp = stamp;
  status.stopped = !reason_.empty();
  status.reason = reason_;
  status.front = front_;
  status_pub_.publish(status);
}

} // namespace navigation
