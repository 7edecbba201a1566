#include <cmath>

#include "navigation/recovery_node.h"

namespace navigation {

StuckWatch::StuckWatch(ros::NodeHandle &private_nh) {
  private_nh.param("stuck_time", stuck_time_, 5.0);
  private_nh.param("min_command", min_command_, 0.05);
  private_nh.param("min_turn_command", min_turn_command_, 0.15);
  double stuck_distance_cm, stuck_turn_deg;
  private_nh.param("stuck_distance_cm", stuck_distance_cm, 15.0);
  private_nh.param("stuck_turn_deg", stuck_turn_deg, 20.0);
  stuck_distance_ = stuck_distance_cm / 100.0;
  stuck_turn_ = stuck_turn_deg * M_PI / 180.0;
}

void StuckWatch::reset(const Pose &pose, const ros::Time &now) {
  anchor_ = pose;
  since_ = now;
}

bool StuckWatch::stuck(const Pose &pose, const geometry_msgs::Twist &wanted,
                       const ros::Time &now) {
  const bool told = std::fabs(wanted.linear.x) > min_command_ ||
                    std::fabs(wanted.angular.z) > min_turn_command_;
  const double moved = std::hypot(pose.x - anchor_.x, pose.y - anchor_.y);
  const double turned = std::fabs(wrapAngle(pose.yaw - anchor_.yaw));
  if (!told || moved > stuck_distance_ || turned > stuck_turn_)
    reset(pose, now);
  return (now - since_).toSec() > stuck_time_;
}

} // namespace navigation
