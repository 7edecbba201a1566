// Fits a laser's scan to the walls of the map.
#ifndef NAVIGATION_SCAN_MATCHER_H
#define NAVIGATION_SCAN_MATCHER_H

#include <vector>

#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>

#include "navigation/floor_plan.h"

namespace navigation {

struct Match {
  Pose pose;
  double fit = 0.0;         ///< mean weight of the used beams, 0 to 1
  double information = 0.0; ///< of the direction that is known worse
  bool accepted = false;
};

/// Point to line, by Gauss and Newton's steps (Chen and Medioni 1991, with the
/// map's walls as the lines), weighted against outliers.
class ScanMatcher {
public:
  explicit ScanMatcher(ros::NodeHandle &private_nh);

  Match match(const Pose &guess, const sensor_msgs::LaserScan &scan) const;

private:
  struct Step {
    double dx = 0.0, dy = 0.0, dyaw = 0.0;
    double weight = 0.0;
    double information = 0.0;
  };
  std::vector<Point> usable(const sensor_msgs::LaserScan &scan) const;
  Step fit(const Pose &pose, const std::vector<Point> &points) const;
  bool plausible(const Pose &guess, const Match &match) const;

  double residual_scale_;
  double min_fit_;
  double min_information_;
  double max_jump_;
  double max_jump_angle_;
  int min_beams_;
};

} // namespace navigation

#endif // NAVIGATION_SCAN_MATCHER_H
