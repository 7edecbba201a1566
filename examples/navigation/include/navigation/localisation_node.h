// The robot's pose: odometry between the scans, the walls of the map at each scan.
#ifndef NAVIGATION_LOCALISATION_NODE_H
#define NAVIGATION_LOCALISATION_NODE_H

#include <nav_msgs/Odometry.h>
#include <navigation/Localised.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>

#include "navigation/scan_matcher.h"

namespace navigation {

/// Whether the recent matches can be relied on.
class Confidence {
public:
  explicit Confidence(ros::NodeHandle &private_nh);

  void update(const Match &match);
  double quality() const { return quality_; }
  bool ready() const { return ready_; }
  bool lost() const { return lost_; }

private:
  double min_quality_;
  int lost_frames_;
  int good_frames_;
  double quality_ = 0.0;
  int rejected_ = 0; ///< in succession
  int accepted_ = 0;
  bool ready_ = false;
  bool lost_ = false;
};

class LocalisationNode {
public:
  LocalisationNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh);

private:
  void onOdometry(const nav_msgs::Odometry &odometry);
  void onScan(const sensor_msgs::LaserScan &scan);
  void takeIn();
  void predict();
  void publish(const ros::Time &stamp);

  ScanMatcher matcher_;
  Confidence confidence_;
  ros::Publisher pose_pub_;
  ros::Subscriber odometry_sub_, scan_sub_;
  nav_msgs::Odometry odometry_;
  sensor_msgs::LaserScan scan_;
  Pose pose_{1.0, 1.2, 0.0}; ///< it begins in its dock
  Pose counted_;             ///< by the wheels, at the last scan
  double max_odometry_step_;
  double max_match_turn_rate_;
  bool enable_matching_;
  bool scan_pending_ = false;
  bool begun_ = false;
};

} // namespace navigation

#endif // NAVIGATION_LOCALISATION_NODE_H
