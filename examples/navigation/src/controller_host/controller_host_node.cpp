#include "navigation/controller_host_node.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <geometry_msgs/TwistStamped.h>

namespace navigation {

namespace {
constexpr double SameGoal = 0.01; // m
} // namespace

ControllerHostNode::ControllerHostNode(ros::NodeHandle &nh,
                                       ros::NodeHandle &private_nh)
    : loader_("navigation", "navigation::Controller") {
  private_nh.param("path_timeout", path_timeout_, 8.0);
  private_nh.param("max_speed_step", max_speed_step_, 0.08);
  private_nh.param("max_turn_step", max_turn_step_, 0.4);
  private_nh.param("careful_quality", careful_quality_, 0.5);
  private_nh.param("careful_speed", careful_speed_, 0.25);
  private_nh.param("wait_for_ready", wait_for_ready_, 5);
  private_nh.param("enable_limits", enable_limits_, true);
  std::string name;
  private_nh.param<std::string>("controller", name, "navigation/PurePursuit");
  controller_ = loader_.createUniqueInstance(name);
  controller_->initialize(nh, private_nh);
  command_pub_ =
      nh.advertise<geometry_msgs::TwistStamped>("/controller/cmd_vel", 10);
  const auto hints = ros::TransportHints().tcpNoDelay();
  path_sub_ = nh.subscribe("/planner/path", 10, &ControllerHostNode::onPath,
                           this, hints);
  mission_sub_ = nh.subscribe("/mission/command", 10,
                              &ControllerHostNode::onMission, this, hints);
  pose_sub_ = nh.subscribe("/localisation/pose", 10,
                           &ControllerHostNode::onPose, this, hints);
}

void ControllerHostNode::onMission(const MissionCommand &command) {
  const bool new_goal = command.goal_id != command_.goal_id;
  command_ = command;
  // Its path comes by another connection, and may have arrived earlier.
  if (new_goal)
    controller_->setPath(poses_, command_.goal_id);
}

void ControllerHostNode::onPath(const nav_msgs::Path &path) {
  path_ = path;
  poses_.clear();
  for (const geometry_msgs::PoseStamped &stamped : path.poses) {
    const geometry_msgs::Pose &pose = stamped.pose;
    poses_.push_back(
        {pose.position.x, pose.position.y,
         2.0 * std::atan2(pose.orientation.z, pose.orientation.w)});
  }
  controller_->setPath(poses_, command_.goal_id);
}

void ControllerHostNode::onPose(const Localised &pose) {
  geometry_msgs::TwistStamped command;
  command.header.stamp = pose.header.stamp;
  command.twist = drive(pose);
  if (enable_limits_)
    limit(command.twist);
  last_ = command.twist;
  command_pub_.publish(command);
}

bool ControllerHostNode::pathFits(const ros::Time &now) const {
  if (path_.poses.empty())
    return false;
  const geometry_msgs::Point &end = path_.poses.back().pose.position;
  const double apart =
      std::hypot(end.x - command_.goal_x, end.y - command_.goal_y);
  return apart < SameGoal && (now - path_.header.stamp).toSec() < path_timeout_;
}

geometry_msgs::Twist ControllerHostNode::drive(const Localised &pose) {
  geometry_msgs::Twist stand;
  unready_ = pose.ready ? 0 : unready_ + 1;
  if (command_.mode != MissionCommand::DRIVE || unready_ >= wait_for_ready_)
    return stand;
  if (!pathFits(pose.header.stamp))
    return stand;
  geometry_msgs::Twist twist = controller_->compute(pose);
  if (pose.quality < careful_quality_)
    twist.linear.x = std::min(twist.linear.x, careful_speed_);
  return twist;
}

void ControllerHostNode::limit(geometry_msgs::Twist &twist) {
  const double faster = twist.linear.x - last_.linear.x;
  if (faster > max_speed_step_)
    twist.linear.x = last_.linear.x + max_speed_step_;
  const double turn = twist.angular.z - last_.angular.z;
  if (std::fabs(turn) > max_turn_step_)
    twist.angular.z = last_.angular.z + std::copysign(max_turn_step_, turn);
}

} // namespace navigation
