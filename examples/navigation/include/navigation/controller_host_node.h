// Loads a controller by its name and lets it drive.
#ifndef NAVIGATION_CONTROLLER_HOST_NODE_H
#define NAVIGATION_CONTROLLER_HOST_NODE_H

#include <memory>
#include <vector>

#include <nav_msgs/Path.h>
#include <navigation/Localised.h>
#include <navigation/MissionCommand.h>
#include <pluginlib/class_loader.hpp>
#include <ros/ros.h>

#include "navigation/controller.h"

namespace navigation {

class ControllerHostNode {
public:
  ControllerHostNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh);

private:
  void onPath(const nav_msgs::Path &path);
  void onMission(const MissionCommand &command);
  void onPose(const Localised &pose);
  bool pathFits(const ros::Time &now) const;
  geometry_msgs::Twist drive(const Localised &pose);
  void limit(geometry_msgs::Twist &twist);

  pluginlib::ClassLoader<Controller> loader_;
  std::shared_ptr<Controller> controller_;
  ros::Publisher command_pub_;
  ros::Subscriber path_sub_, mission_sub_, pose_sub_;
  MissionCommand command_;
  nav_msgs::Path path_;
  std::vector<Pose> poses_; ///< of the path
  geometry_msgs::Twist last_;
  double path_timeout_;
  double max_speed_step_; ///< m/s, from one pose to the next: it brakes at once
  double max_turn_step_;  ///< rad/s
  double careful_quality_;
  double careful_speed_;
  int wait_for_ready_;
  int unready_ = 0; ///< poses in succession
  bool enable_limits_;
};

} // namespace navigation

#endif // NAVIGATION_CONTROLLER_HOST_NODE_H
