// What an observer sees: the true poses.
#ifndef SIMULATED_WORLD_TRUTH_H
#define SIMULATED_WORLD_TRUTH_H

#include <cmath>

#include <geometry_msgs/PoseStamped.h>
#include <ros/ros.h>

namespace simulated_world {

/// m and rad.
inline geometry_msgs::PoseStamped poseAt(const ros::Time &stamp, double x,
                                         double y, double z, double yaw) {
  geometry_msgs::PoseStamped pose;
  pose.header.stamp = stamp;
  pose.header.frame_id = "map";
  pose.pose.position.x = x;
  pose.pose.position.y = y;
  pose.pose.position.z = z;
  pose.pose.orientation.z = std::sin(0.5 * yaw);
  pose.pose.orientation.w = std::cos(0.5 * yaw);
  return pose;
}

} // namespace simulated_world

#endif // SIMULATED_WORLD_TRUTH_H
