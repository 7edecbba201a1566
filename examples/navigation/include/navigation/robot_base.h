// The robot's base: two driven wheels that slip, what they count, the battery.
#ifndef NAVIGATION_ROBOT_BASE_H
#define NAVIGATION_ROBOT_BASE_H

#include <geometry_msgs/Twist.h>
#include <nav_msgs/Odometry.h>
#include <navigation/RobotStatus.h>
#include <ros/ros.h>
#include <simulated_world/noise.h>

#include "navigation/arena.h"

namespace navigation {

class RobotBase {
public:
  RobotBase(ros::NodeHandle &private_nh, std::uint32_t seed);

  /// It stops before it would move into something.
  void step(const geometry_msgs::Twist &command, const Arena &arena,
            double interval);
  nav_msgs::Odometry odometry(const ros::Time &stamp);
  /// What the base reports about itself. With an empty battery the wheels stand
  /// still until it reports otherwise.
  RobotStatus status(const ros::Time &stamp);
  const Pose &pose() const { return pose_; }
  bool contact() const { return contact_; }

private:
  void count(double interval);
  double voltage() const;

  simulated_world::Noise noise_;
  simulated_world::SlowNoise slip_{0.03, 1.5};
  simulated_world::SlowNoise turn_slip_{0.04, 1.5};
  simulated_world::SlowNoise sway_{0.01, 0.8};
  Pose pose_{1.0, 1.2, 0.0};
  Pose counted_{1.0, 1.2, 0.0}; ///< where the wheels think it is
  double speed_ = 0.0;          ///< m/s
  double turn_rate_ = 0.0;      ///< rad/s
  double charge_ = 1.0;         ///< of the battery, 0 to 1
  double battery_seconds_;
  double battery_empty_voltage_;
  double max_wheel_speed_;
  bool enable_slip_;
  bool empty_ = false;
  bool contact_ = false;
};

} // namespace navigation

#endif // NAVIGATION_ROBOT_BASE_H
