#include "navigation/obstacle_grid.h"

#include <algorithm>
#include <cmath>

namespace navigation {

namespace {
constexpr double Far = 1.0;         // m: clearance is not measured farther
constexpr double MarkRange = 3.0;   // m: farther a small turn is a long way
constexpr double WallMargin = 0.15; // m
constexpr int MostHits = 12;
constexpr double Weight = 6.0;     // of discomfort near an obstacle
constexpr double Comfort = 0.25;   // m in which it falls to a third
constexpr double BeforeHit = 0.15; // m: not cleared so near to a hit
} // namespace

ObstacleGrid::ObstacleGrid(ros::NodeHandle &private_nh)
    : wall_(Columns * Rows, false), marked_(Columns * Rows, false),
      hits_(Columns * Rows, 0), clearance_(Columns * Rows, Far) {
  private_nh.param("inflation_radius", inflation_radius_, 0.33);
  private_nh.param("occupied_hits", occupied_hits_, 4);
  for (int row = 0; row < Rows; ++row)
    for (int column = 0; column < Columns; ++column)
      for (const Box &box : walls())
        if (distanceTo(box, centre({column, row})) < 0.5 * Resolution + 1e-9)
          wall_[index({column, row})] = true;
}

bool ObstacleGrid::inside(const Cell &cell) {
  return cell.column >= 0 && cell.column < Columns && cell.row >= 0 &&
         cell.row < Rows;
}

std::size_t ObstacleGrid::index(const Cell &cell) {
  return static_cast<std::size_t>(cell.row * Columns + cell.column);
}

Cell ObstacleGrid::cellAt(const Point &point) {
  return {static_cast<int>(std::floor(point.x / Resolution)),
          static_cast<int>(std::floor(point.y / Resolution))};
}

Point ObstacleGrid::centre(const Cell &cell) {
  return {(cell.column + 0.5) * Resolution, (cell.row + 0.5) * Resolution};
}

void ObstacleGrid::update(const Pose &robot,
                          const sensor_msgs::LaserScan &scan) {
  for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam) {
    const double range = scan.ranges[beam];
    if (!std::isfinite(range))
      continue;
    const double angle = robot.yaw + scan.angle_min +
                         static_cast<double>(beam) * scan.angle_increment;
    clear(robot, angle, range);
    if (range < MarkRange)
      mark({robot.x + range * std::cos(angle),
            robot.y + range * std::sin(angle)});
  }
}

void ObstacleGrid::mark(const Point &point) {
  const Cell cell = cellAt(point);
  if (!inside(cell))
    return;
  for (const Box &wall : walls())
    if (distanceTo(wall, point) < WallMargin)
      return; // the map has it
  int &hits = hits_[index(cell)];
  hits = std::min(hits + 2, MostHits);
  if (hits >= occupied_hits_)
    marked_[index(cell)] = true;
}

void ObstacleGrid::clear(const Pose &robot, double angle, double range) {
  const double end = std::min(range - BeforeHit, MarkRange);
  const double dx = std::cos(angle), dy = std::sin(angle);
  std::size_t last = hits_.size();
  for (double way = 0.0; way < end; way += 0.5 * Resolution) {
    const Cell cell = cellAt({robot.x + way * dx, robot.y + way * dy});
    if (!inside(cell) || index(cell) == last)
      continue;
    last = index(cell);
    if (hits_[last] > 0)
      --hits_[last];
    else
      marked_[last] = false;
  }
}

bool ObstacleGrid::occupied(std::size_t index) const {
  return wall_[index] || marked_[index];
}

void ObstacleGrid::measureClearance() {
  constexpr int Reach = static_cast<int>(Far / Resolution);
  std::fill(clearance_.begin(), clearance_.end(), Far);
  for (int row = 0; row < Rows; ++row)
    for (int column = 0; column < Columns; ++column) {
      if (!occupied(index({column, row})))
        continue;
      for (int dr = -Reach; dr <= Reach; ++dr)
        for (int dc = -Reach; dc <= Reach; ++dc) {
          const Cell near{column + dc, row + dr};
          if (!inside(near))
            continue;
          double &clearance = clearance_[index(near)];
          clearance = std::min(clearance, Resolution * std::hypot(dc, dr));
        }
    }
}

bool ObstacleGrid::lethal(const Cell &cell) const {
  return clearance(cell) < inflation_radius_;
}

double ObstacleGrid::clearance(const Cell &cell) const {
  return clearance_[index(cell)];
}

double ObstacleGrid::discomfort(const Cell &cell) const {
  return Weight * std::exp(-clearance(cell) / Comfort);
}

nav_msgs::OccupancyGrid ObstacleGrid::message(const ros::Time &stamp) const {
  nav_msgs::OccupancyGrid grid;
  grid.header.stamp = stamp;
  grid.header.frame_id = "map";
  grid.info.resolution = static_cast<float>(Resolution);
  grid.info.width = Columns;
  grid.info.height = Rows;
  grid.info.origin.orientation.w = 1.0;
  for (std::size_t i = 0; i < hits_.size(); ++i)
    grid.data.push_back(occupied(i) ? 100 : 0);
  return grid;
}

} // namespace navigation
