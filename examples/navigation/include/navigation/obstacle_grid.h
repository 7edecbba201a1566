// What the planner knows about the floor: the walls of the map, and the other
// obstacles that the laser hits.
#ifndef NAVIGATION_OBSTACLE_GRID_H
#define NAVIGATION_OBSTACLE_GRID_H

#include <vector>

#include <nav_msgs/OccupancyGrid.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>

#include "navigation/floor_plan.h"

namespace navigation {

struct Cell {
  int column = 0, row = 0;
};

class ObstacleGrid {
public:
  static constexpr double Resolution = 0.1; ///< m
  static constexpr int Columns = 80;
  static constexpr int Rows = 60;

  explicit ObstacleGrid(ros::NodeHandle &private_nh);

  /// Counts the cells that a scan from `robot` hits, and clears those that it passes.
  void update(const Pose &robot, const sensor_msgs::LaserScan &scan);
  /// Recomputes the clearance of all cells.
  void measureClearance();

  static bool inside(const Cell &cell);
  static Cell cellAt(const Point &point);
  static Point centre(const Cell &cell);
  /// Whether the robot's centre must not be there.
  bool lethal(const Cell &cell) const;
  /// To the nearest occupied cell, m.
  double clearance(const Cell &cell) const;
  /// How much more a step into a cell costs than on free floor, 0 or more.
  double discomfort(const Cell &cell) const;
  nav_msgs::OccupancyGrid message(const ros::Time &stamp) const;

private:
  static std::size_t index(const Cell &cell);
  void mark(const Point &point);
  void clear(const Pose &robot, double angle, double range);
  bool occupied(std::size_t index) const;

  double inflation_radius_;
  int occupied_hits_;
  std::vector<bool> wall_;
  std::vector<bool> marked_; ///< by the laser
  std::vector<int> hits_;
  std::vector<double> clearance_;
};

} // namespace navigation

#endif // NAVIGATION_OBSTACLE_GRID_H
