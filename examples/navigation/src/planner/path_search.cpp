#include "navigation/path_search.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <queue>

namespace navigation {

namespace {
constexpr int Cells = ObstacleGrid::Columns * ObstacleGrid::Rows;

struct Open {
  double estimate;
  int cell;
  // The smallest on top of the queue; equal ones in a fixed order.
  bool operator<(const Open &other) const {
    if (estimate != other.estimate)
      return estimate > other.estimate;
    return cell > other.cell;
  }
};

int number(const Cell &cell) {
  return cell.row * ObstacleGrid::Columns + cell.column;
}

Cell cellOf(int number) {
  return {number % ObstacleGrid::Columns, number / ObstacleGrid::Columns};
}

double between(const Cell &a, const Cell &b) {
  return std::hypot(a.column - b.column, a.row - b.row);
}

/// The shortest path with steps to eight neighbours.
double stepsBetween(const Cell &a, const Cell &b) {
  const int columns = std::abs(a.column - b.column);
  const int rows = std::abs(a.row - b.row);
  return std::max(columns, rows) + (M_SQRT2 - 1.0) * std::min(columns, rows);
}

std::vector<Point> trace(const std::vector<int> &parents, int last) {
  std::vector<Point> points;
  for (int cell = last; cell >= 0;
       cell = parents[static_cast<std::size_t>(cell)])
    points.push_back(ObstacleGrid::centre(cellOf(cell)));
  std::reverse(points.begin(), points.end());
  return points;
}
} // namespace

PathSearch::PathSearch(ros::NodeHandle &private_nh) {
  private_nh.param("snap_distance", snap_distance_, 0.45);
  private_nh.param("max_expansions", max_expansions_, 6000);
  private_nh.param("keep_clear", keep_clear_, true);
}

std::optional<Cell> PathSearch::nearestFree(const ObstacleGrid &grid,
                                            const Point &point) const {
  const Cell middle = ObstacleGrid::cellAt(point);
  if (ObstacleGrid::inside(middle) && !grid.lethal(middle))
    return middle;
  constexpr int Reach = 6;
  Cell nearest = middle;
  double least = std::numeric_limits<double>::infinity();
  for (int row = -Reach; row <= Reach; ++row)
    for (int column = -Reach; column <= Reach; ++column) {
      const Cell cell{middle.column + column, middle.row + row};
      const double away = ObstacleGrid::Resolution * between(cell, middle);
      if (!ObstacleGrid::inside(cell) || away >= least || grid.lethal(cell))
        continue;
      least = away;
      nearest = cell;
    }
  if (least > snap_distance_)
    return std::nullopt;
  return nearest;
}

Plan PathSearch::search(const ObstacleGrid &grid, const Point &from,
                        const Point &to) const {
  Plan plan;
  const std::optional<Cell> start = nearestFree(grid, from);
  const std::optional<Cell> goal = nearestFree(grid, to);
  if (!start || !goal)
    return plan;
  std::vector<double> cost(Cells, std::numeric_limits<double>::infinity());
  std::vector<int> parents(Cells, -1);
  std::vector<bool> closed(Cells, false);
  std::priority_queue<Open> open;
  const double dread = keep_clear_ ? 1.0 : 0.0;
  const auto at = [](int cell) { return static_cast<std::size_t>(cell); };
  cost[at(number(*start))] = 0.0;
  open.push({stepsBetween(*start, *goal), number(*start)});
  while (!open.empty()) {
    const int current = open.top().cell;
    open.pop();
    if (closed[at(current)])
      continue;
    closed[at(current)] = true;
    const Cell cell = cellOf(current);
    // Evaluated late: most cells that are opened are never visited.
    if (grid.lethal(cell))
      continue;
    if (++plan.expansions > max_expansions_)
      return plan;
    if (current == number(*goal)) {
      plan.points = trace(parents, current);
      return plan;
    }
    for (int dr = -1; dr <= 1; ++dr)
      for (int dc = -1; dc <= 1; ++dc) {
        const Cell next{cell.column + dc, cell.row + dr};
        if (!ObstacleGrid::inside(next))
          continue;
        const int id = number(next);
        const double through =
            cost[at(current)] +
            std::hypot(dr, dc) * (1.0 + dread * grid.discomfort(next));
        if (through < cost[at(id)]) {
          cost[at(id)] = through;
          parents[at(id)] = current;
          open.push({through + stepsBetween(next, *goal), id});
        }
      }
  }
  return plan;
}

} // namespace navigation
