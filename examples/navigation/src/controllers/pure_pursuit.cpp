#include "navigation/pure_pursuit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <navigation/ControllerStatus.h>

namespace navigation {

namespace {
constexpr double TurnGain = 1.8; // 1/s
constexpr double SlowGain = 0.8; // 1/s
constexpr double Degree = M_PI / 180.0;
} // namespace

void PurePursuit::initialize(ros::NodeHandle &nh, ros::NodeHandle &private_nh) {
  private_nh.param("lookahead", lookahead_, 0.45);
  private_nh.param("cruise_speed", cruise_speed_, 0.5);
  private_nh.param("slow_down_distance", slow_down_distance_, 0.7);
  private_nh.param("min_speed", min_speed_, 0.08);
  private_nh.param("goal_tolerance", goal_tolerance_, 0.12);
  private_nh.param("max_turn_rate", max_turn_rate_, 1.2);
  private_nh.param("min_turn_rate", min_turn_rate_, 0.12);
  private_nh.param("sharp_curvature", sharp_curvature_, 1.2);
  private_nh.param("sharp_speed", sharp_speed_, 0.3);
  private_nh.param("turn_at_goal", turn_at_goal_, true);
  private_nh.param("aligned_frames", aligned_frames_, 5);
  double heading_tolerance_deg, turn_in_place_deg, turn_exit_deg;
  private_nh.param("heading_tolerance_deg", heading_tolerance_deg, 6.0);
  private_nh.param("turn_in_place_deg", turn_in_place_deg, 70.0);
  private_nh.param("turn_exit_deg", turn_exit_deg, 20.0);
  heading_tolerance_ = heading_tolerance_deg * Degree;
  turn_in_place_angle_ = turn_in_place_deg * Degree;
  turn_exit_angle_ = turn_exit_deg * Degree;
  status_pub_ = nh.advertise<ControllerStatus>("/controller/status", 10);
}

void PurePursuit::setPath(const std::vector<Pose> &path,
                          std::uint32_t goal_id) {
  if (goal_id != goal_id_) {
    turning_ = near_goal_ = arrived_ = false;
    aligned_ = 0;
  }
  goal_id_ = goal_id;
  path_ = path;
}

Point PurePursuit::target(const Point &robot) const {
  // The first point after the nearest one that is far enough ahead.
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < path_.size(); ++i) {
    const double away = std::hypot(path_[i].x - robot.x, path_[i].y - robot.y);
    if (away < least) {
      least = away;
      nearest = i;
    }
  }
  double way = 0.0;
  std::size_t ahead = nearest;
  while (ahead + 1 < path_.size() && way < lookahead_) {
    way += std::hypot(path_[ahead + 1].x - path_[ahead].x,
                      path_[ahead + 1].y - path_[ahead].y);
    ++ahead;
  }
  return {path_[ahead].x, path_[ahead].y};
}

double PurePursuit::misalignment() const { return std::fabs(heading_error_); }

geometry_msgs::Twist PurePursuit::compute(const Localised &robot) {
  geometry_msgs::Twist twist;
  if (path_.empty())
    return twist;
  const Pose &goal = path_.back();
  distance_ = std::hypot(goal.x - robot.x, goal.y - robot.y);
  heading_error_ = wrapAngle(goal.yaw - robot.yaw);
  // Once there, it does not correct what the turn moves it.
  if (distance_ < goal_tolerance_)
    near_goal_ = true;
  if (!near_goal_) {
    twist = follow(robot, distance_);
  } else if (turn_at_goal_ && !arrived_) {
    twist = align();
  } else {
    arrived_ = true;
  }
  publish(robot, twist);
  return twist;
}

geometry_msgs::Twist PurePursuit::follow(const Localised &robot,
                                         double distance) {
  geometry_msgs::Twist twist;
  const Point point = target({robot.x, robot.y});
  const double dx = point.x - robot.x, dy = point.y - robot.y;
  bearing_ = wrapAngle(std::atan2(dy, dx) - robot.yaw);
  if (std::fabs(bearing_) > turn_in_place_angle_)
    turning_ = true;
  else if (std::fabs(bearing_) < turn_exit_angle_)
    turning_ = false;
  if (turning_)
    return turnTo(bearing_);
  const double curvature = 2.0 * std::sin(bearing_) / std::hypot(dx, dy);
  double speed = cruise_speed_;
  if (std::fabs(curvature) > sharp_curvature_)
    speed = sharp_speed_;
  if (distance < slow_down_distance_)
    speed = std::min(speed, SlowGain * distance);
  if (speed < min_speed_)
    speed = min_speed_;
  twist.linear.x = speed;
  twist.angular.z = limitedTurn(speed * curvature);
  return twist;
}

geometry_msgs::Twist PurePursuit::align() {
  if (misalignment() > heading_tolerance_) {
    aligned_ = 0;
    return turnTo(heading_error_);
  }
  // Passing by is not enough: it has to stay so.
  if (++aligned_ >= aligned_frames_)
    arrived_ = true;
  return {};
}

geometry_msgs::Twist PurePursuit::turnTo(double heading_error) {
  geometry_msgs::Twist twist;
  double turn_rate = limitedTurn(TurnGain * heading_error);
  // Below this speed the wheels would not turn at all.
  if (std::fabs(turn_rate) < min_turn_rate_)
    turn_rate = std::copysign(min_turn_rate_, turn_rate);
  twist.angular.z = turn_rate;
  return twist;
}

double PurePursuit::limitedTurn(double turn_rate) const {
  if (std::fabs(turn_rate) > max_turn_rate_)
    return std::copysign(max_turn_rate_, turn_rate);
  return turn_rate;
}

void PurePursuit::publish(const Localised &robot,
                          const geometry_msgs::Twist &twist) {
  ControllerStatus status;
  status.header.stamp = robot.header.stamp;
  status.goal_id = goal_id_;
  status.distance = distance_;
  status.bearing = bearing_;
  status.heading_error = heading_error_;
  status.speed = twist.linear.x;
  status.turn_rate = twist.angular.z;
  status.near_goal = near_goal_;
  status.arrived = arrived_;
  status_pub_.publish(status);
}

} // namespace navigation
