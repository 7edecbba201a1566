// Plans the robot's path, and plans it again when needed.
#ifndef NAVIGATION_PLANNER_NODE_H
#define NAVIGATION_PLANNER_NODE_H

#include <navigation/Localised.h>
#include <navigation/MissionCommand.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>

#include "navigation/obstacle_grid.h"
#include "navigation/path_search.h"

namespace navigation {

class PlannerNode {
public:
  PlannerNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh);

private:
  void onPose(const Localised &pose);
  void onScan(const sensor_msgs::LaserScan &scan);
  void onMission(const MissionCommand &command);
  void takeIn();
  bool outdated(const ros::Time &now);
  double deviation() const;
  double narrowest() const;
  void plan(const ros::Time &now);
  void publishGrid(const ros::Time &now);

  ObstacleGrid grid_;
  PathSearch search_;
  ros::Publisher path_pub_, status_pub_, grid_pub_;
  ros::Subscriber pose_sub_, scan_sub_, mission_sub_;
  Localised pose_;
  sensor_msgs::LaserScan scan_;
  MissionCommand command_;
  Plan plan_;
  ros::Time planned_, grid_published_;
  std::uint32_t planned_goal_ = 0;
  std::uint32_t plans_ = 0;
  double replan_period_;
  double retry_period_;
  double max_deviation_;
  double grid_period_;
  double min_map_quality_;
  double min_clearance_;
  bool pose_pending_ = false;
};

} // namespace navigation

#endif // NAVIGATION_PLANNER_NODE_H
