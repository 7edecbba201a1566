// The cheapest way over the grid.
#ifndef NAVIGATION_PATH_SEARCH_H
#define NAVIGATION_PATH_SEARCH_H

#include <optional>
#include <vector>

#include <ros/ros.h>

#include "navigation/obstacle_grid.h"

namespace navigation {

struct Plan {
  std::vector<Point> points; ///< empty where there is no way
  int expansions = 0;
};

/// A* (Hart, Nilsson and Raphael 1968) to the eight neighbours of a cell.
class PathSearch {
public:
  explicit PathSearch(ros::NodeHandle &private_nh);

  Plan search(const ObstacleGrid &grid, const Point &from,
              const Point &to) const;

private:
  std::optional<Cell> nearestFree(const ObstacleGrid &grid,
                                  const Point &point) const;

  double snap_distance_;
  int max_expansions_;
  bool keep_clear_;
};

} // namespace navigation

#endif // NAVIGATION_PATH_SEARCH_H
