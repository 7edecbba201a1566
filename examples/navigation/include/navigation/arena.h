// The obstacles in the arena, a cart that rolls through it, and what a laser sees.
#ifndef NAVIGATION_ARENA_H
#define NAVIGATION_ARENA_H

#include <vector>

#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <simulated_world/noise.h>

#include "navigation/floor_plan.h"

namespace navigation {

constexpr double RobotRadius = 0.2; ///< m

/// A cart that somebody pushes across the robot's path without looking.
class Cart {
public:
  /// It begins when the robot comes through the doorway.
  void step(const Pose &robot, double interval);
  Box box() const;
  const Point &place() const { return place_; }

private:
  Point place_{5.15, 5.6};
  bool rolling_ = false;
};

class Arena {
public:
  Arena(ros::NodeHandle &private_nh, std::uint32_t seed);

  void step(const Pose &robot, double interval);
  /// Whether a robot at this pose touches something.
  bool touches(const Point &place) const;
  sensor_msgs::LaserScan scan(const ros::Time &stamp, const Pose &robot);
  const Cart &cart() const { return cart_; }

private:
  std::vector<Box> obstacles() const;

  simulated_world::Noise noise_;
  Cart cart_;
  double next_dust_; ///< s until the next cloud
  double dust_left_ = 0.0;
  double laser_noise_;
  double laser_dropout_;
  double dust_dropout_;
  double dust_every_;
  bool enable_dust_;
};

} // namespace navigation

#endif // NAVIGATION_ARENA_H
