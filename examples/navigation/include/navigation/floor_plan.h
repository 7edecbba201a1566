// The map: the walls that everybody knows, and the geometry of boxes.
#ifndef NAVIGATION_FLOOR_PLAN_H
#define NAVIGATION_FLOOR_PLAN_H

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace navigation {

constexpr double ArenaWidth = 8.0;  ///< m, along x
constexpr double ArenaHeight = 6.0; ///< m, along y

struct Point {
  double x = 0.0, y = 0.0;
};

/// Along the axes; m.
struct Box {
  double min_x, min_y, max_x, max_y;
};

/// m and rad.
struct Pose {
  double x = 0.0, y = 0.0, yaw = 0.0;
};

inline double wrapAngle(double angle) {
  return std::remainder(angle, 2.0 * M_PI);
}

/// The outer walls, and the wall in the middle with its doorway.
inline const std::vector<Box> &walls() {
  static const std::vector<Box> Walls = {
      {-0.1, -0.1, ArenaWidth + 0.1, 0.0},
      {-0.1, ArenaHeight, ArenaWidth + 0.1, ArenaHeight + 0.1},
      {-0.1, -0.1, 0.0, ArenaHeight + 0.1},
      {ArenaWidth, -0.1, ArenaWidth + 0.1, ArenaHeight + 0.1},
      {3.95, 0.0, 4.05, 2.3},
      {3.95, 3.3, 4.05, ArenaHeight},
  };
  return Walls;
}

/// The point on a box's outline that is nearest to a point inside or outside of
/// it.
inline Point nearestOnBox(const Box &box, const Point &point) {
  const double x = std::clamp(point.x, box.min_x, box.max_x);
  const double y = std::clamp(point.y, box.min_y, box.max_y);
  if (x != point.x || y != point.y)
    return {x, y};
  const double left = x - box.min_x, right = box.max_x - x;
  const double below = y - box.min_y, above = box.max_y - y;
  const double least = std::min({left, right, below, above});
  if (least == left)
    return {box.min_x, y};
  if (least == right)
    return {box.max_x, y};
  return {x, least == below ? box.min_y : box.max_y};
}

/// The distance to a box's outline, m; 0 inside.
inline double distanceTo(const Box &box, const Point &point) {
  const double dx = std::max({box.min_x - point.x, point.x - box.max_x, 0.0});
  const double dy = std::max({box.min_y - point.y, point.y - box.max_y, 0.0});
  return std::hypot(dx, dy);
}

/// The distance at which a ray hits a box (the slab method of Kay and Kajiya);
/// infinite if it does not.
inline double rayToBox(const Box &box, const Point &from, double angle) {
  const double dx = std::cos(angle), dy = std::sin(angle);
  double enter = 0.0, leave = std::numeric_limits<double>::infinity();
  const auto slab = [&](double origin, double step, double low, double high) {
    if (std::fabs(step) < 1e-12) {
      if (origin < low || origin > high)
        leave = -1.0;
      return;
    }
    const double a = (low - origin) / step, b = (high - origin) / step;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  };
  slab(from.x, dx, box.min_x, box.max_x);
  slab(from.y, dy, box.min_y, box.max_y);
  return enter <= leave ? enter : std::numeric_limits<double>::infinity();
}

} // namespace navigation

#endif // NAVIGATION_FLOOR_PLAN_H
