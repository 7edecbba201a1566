#include "navigation/planner_node.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <nav_msgs/Path.h>
#include <navigation/PlanStatus.h>

namespace navigation {

PlannerNode::PlannerNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh)
    : grid_(private_nh), search_(private_nh) {
  private_nh.param("replan_period", replan_period_, 3.0);
  private_nh.param("retry_period", retry_period_, 0.5);
  private_nh.param("max_deviation", max_deviation_, 0.35);
  private_nh.param("grid_period", grid_period_, 1.0);
  private_nh.param("min_map_quality", min_map_quality_, 0.4);
  private_nh.param("min_clearance", min_clearance_, 0.25);
  path_pub_ = nh.advertise<nav_msgs::Path>("/planner/path", 10);
  status_pub_ = nh.advertise<PlanStatus>("/planner/status", 10);
  grid_pub_ = nh.advertise<nav_msgs::OccupancyGrid>("/planner/grid", 2);
  const auto hints = ros::TransportHints().tcpNoDelay();
  pose_sub_ =
      nh.subscribe("/localisation/pose", 10, &PlannerNode::onPose, this, hints);
  scan_sub_ = nh.subscribe("/scan", 10, &PlannerNode::onScan, this, hints);
  mission_sub_ = nh.subscribe("/mission/command", 10, &PlannerNode::onMission,
                              this, hints);
}

void PlannerNode::onPose(const Localised &pose) {
  pose_ = pose;
  pose_pending_ = true;
  takeIn();
}

void PlannerNode::onScan(const sensor_msgs::LaserScan &scan) {
  scan_ = scan;
  takeIn();
}

void PlannerNode::onMission(const MissionCommand &command) {
  command_ = command;
}

void PlannerNode::takeIn() {
  if (!pose_pending_ || scan_.header.stamp < pose_.header.stamp)
    return;
  pose_pending_ = false;
  const ros::Time now = pose_.header.stamp;
  // An uncertain pose would put obstacles where there are none.
  if (pose_.quality > min_map_quality_)
    grid_.update({pose_.x, pose_.y, pose_.yaw}, scan_);
  if (command_.mode == MissionCommand::DRIVE && outdated(now))
    plan(now);
  if ((now - grid_published_).toSec() > grid_period_)
    publishGrid(now);
  PlanStatus status;
  status.header.stamp = now;
  status.goal_id = planned_goal_;
  status.has_plan = !plan_.points.empty();
  status.plans = plans_;
  status.expansions = static_cast<std::uint32_t>(plan_.expansions);
  status_pub_.publish(status);
}

bool PlannerNode::outdated(const ros::Time &now) {
  if (command_.goal_id != planned_goal_)
    return true;
  const double age = (now - planned_).toSec();
  if (age < retry_period_)
    return false;
  if (plan_.points.empty() || age > replan_period_)
    return true;
  if (deviation() > max_deviation_)
    return true;
  grid_.measureClearance();
  return narrowest() < min_clearance_;
}

double PlannerNode::deviation() const {
  double least = std::numeric_limits<double>::infinity();
  for (const Point &point : plan_.points)
    least = std::min(least, std::hypot(point.x - pose_.x, point.y - pose_.y));
  return least;
}

double PlannerNode::narrowest() const {
  double least = std::numeric_limits<double>::infinity();
  for (const Point &point : plan_.points)
    least = std::min(least, grid_.clearance(ObstacleGrid::cellAt(point)));
  return least;
}

void PlannerNode::plan(const ros::Time &now) {
  grid_.measureClearance();
  plan_ = search_.search(grid_, {pose_.x, pose_.y},
                         {command_.goal_x, command_.goal_y});
  planned_ = now;
  planned_goal_ = command_.goal_id;
  ++plans_;
  nav_msgs::Path path;
  path.header.stamp = now;
  path.header.frame_id = "map";
  for (const Point &point : plan_.points) {
    geometry_msgs::PoseStamped pose;
    pose.header = path.header;
    pose.pose.position.x = point.x;
    pose.pose.position.y = point.y;
    pose.pose.orientation.w = 1.0;
    path.poses.push_back(pose);
  }
  // The grid's cell is near the goal, not exactly at it.
  if (!path.poses.empty()) {
    geometry_msgs::Pose &last = path.poses.back().pose;
    last.position.x = command_.goal_x;
    last.position.y = command_.goal_y;
    last.orientation.z = std::sin(0.5 * command_.goal_yaw);
    last.orientation.w = std::cos(0.5 * command_.goal_yaw);
  }
  path_pub_.publish(path);
}

void PlannerNode::publishGrid(const ros::Time &now) {
  grid_published_ = now;
  grid_pub_.publish(grid_.message(now));
}

} // namespace navigation
