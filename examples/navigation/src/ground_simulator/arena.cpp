#include "navigation/arena.h"

#include <algorithm>
#include <limits>

namespace navigation {

namespace {
constexpr double CartHalf = 0.2;    // m
constexpr double CartSpeed = 0.55;  // m/s
constexpr double CartEnd = 0.4;     // y, m
constexpr double CartTrigger = 3.3; // x of the robot, m
constexpr double LaserRange = 6.0;  // m
constexpr int Beams = 120;
constexpr double DustTime = 0.35; // s

// They are not on the map.
const std::vector<Box> &boxes() {
  static const std::vector<Box> Boxes = {
      {2.3, 1.7, 2.7, 2.1}, {5.7, 3.0, 6.2, 3.5}, {6.8, 1.6, 7.2, 2.0}};
  return Boxes;
}

double castRay(const std::vector<Box> &obstacles, const Point &from,
               double angle) {
  double range = std::numeric_limits<double>::infinity();
  for (const Box &box : obstacles)
    range = std::min(range, rayToBox(box, from, angle));
  return range;
}
} // namespace

void Cart::step(const Pose &robot, double interval) {
  if (robot.x > CartTrigger)
    rolling_ = true;
  if (rolling_ && place_.y > CartEnd)
    place_.y -= CartSpeed * interval;
}

Box Cart::box() const {
  return {place_.x - CartHalf, place_.y - CartHalf, place_.x + CartHalf,
          place_.y + CartHalf};
}

Arena::Arena(ros::NodeHandle &private_nh, std::uint32_t seed) : noise_(seed) {
  private_nh.param("laser_noise", laser_noise_, 0.01);
  private_nh.param("laser_dropout", laser_dropout_, 0.02);
  private_nh.param("dust_dropout", dust_dropout_, 0.8);
  private_nh.param("dust_every", dust_every_, 8.0);
  private_nh.param("enable_dust", enable_dust_, true);
  next_dust_ = noise_.waitingTime(dust_every_);
}

void Arena::step(const Pose &robot, double interval) {
  cart_.step(robot, interval);
  dust_left_ -= interval;
  next_dust_ -= interval;
  if (next_dust_ < 0.0) {
    dust_left_ = DustTime;
    next_dust_ = DustTime + noise_.waitingTime(dust_every_);
  }
}

std::vector<Box> Arena::obstacles() const {
  std::vector<Box> all = walls();
  all.insert(all.end(), boxes().begin(), boxes().end());
  all.push_back(cart_.box());
  return all;
}

bool Arena::touches(const Point &place) const {
  for (const Box &box : obstacles())
    if (distanceTo(box, place) < RobotRadius)
      return true;
  return false;
}

sensor_msgs::LaserScan Arena::scan(const ros::Time &stamp, const Pose &robot) {
  sensor_msgs::LaserScan scan;
  scan.header.stamp = stamp;
  scan.header.frame_id = "laser";
  scan.angle_min = static_cast<float>(-M_PI);
  scan.angle_increment = static_cast<float>(2.0 * M_PI / Beams);
  scan.angle_max = scan.angle_min + (Beams - 1) * scan.angle_increment;
  scan.range_min = 0.05f;
  scan.range_max = static_cast<float>(LaserRange);
  const bool dusty = enable_dust_ && dust_left_ > 0.0;
  const double dropout = dusty ? dust_dropout_ : laser_dropout_;
  const std::vector<Box> standing = obstacles();
  for (int beam = 0; beam < Beams; ++beam) {
    const double angle = scan.angle_min + beam * scan.angle_increment;
    const double range =
        castRay(standing, {robot.x, robot.y}, robot.yaw + angle) +
        noise_.gaussian(laser_noise_);
    const bool lost = noise_.chance(dropout) || range > LaserRange;
    scan.ranges.push_back(lost ? std::numeric_limits<float>::infinity()
                               : static_cast<float>(range));
  }
  return scan;
}

} // namespace navigation
