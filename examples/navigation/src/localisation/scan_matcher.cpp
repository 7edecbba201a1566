#include "navigation/scan_matcher.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace navigation {

namespace {
constexpr int Rounds = 4;
constexpr double Damping = 1e-3;

/// Solves the symmetric 3x3 system by Cholesky's factors; damped, so that it
/// always has a solution.
void solve(double a[3][3], double b[3]) {
  for (int i = 0; i < 3; ++i) {
    a[i][i] += Damping;
    for (int j = 0; j < i; ++j) {
      for (int k = 0; k < j; ++k)
        a[i][j] -= a[i][k] * a[j][k];
      a[i][j] /= a[j][j];
      a[i][i] -= a[i][j] * a[i][j];
    }
    a[i][i] = std::sqrt(a[i][i]);
  }
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < i; ++k)
      b[i] -= a[i][k] * b[k];
    b[i] /= a[i][i];
  }
  for (int i = 2; i >= 0; --i) {
    for (int k = i + 1; k < 3; ++k)
      b[i] -= a[k][i] * b[k];
    b[i] /= a[i][i];
  }
}

struct Nearest {
  Point point;
  double distance;
};

Nearest nearestOnWalls(const Point &point) {
  Nearest nearest{{}, std::numeric_limits<double>::infinity()};
  for (const Box &wall : walls()) {
    const Point on_wall = nearestOnBox(wall, point);
    const double away = std::hypot(on_wall.x - point.x, on_wall.y - point.y);
    if (away < nearest.distance)
      nearest = {on_wall, away};
  }
  return nearest;
}
} // namespace

ScanMatcher::ScanMatcher(ros::NodeHandle &private_nh) {
  private_nh.param("residual_scale", residual_scale_, 0.1);
  private_nh.param("min_fit", min_fit_, 0.45);
  private_nh.param("min_information", min_information_, 4.0);
  private_nh.param("max_jump", max_jump_, 0.3);
  private_nh.param("min_beams", min_beams_, 40);
  double max_jump_angle_deg;
  private_nh.param("max_jump_angle_deg", max_jump_angle_deg, 15.0);
  max_jump_angle_ = max_jump_angle_deg * M_PI / 180.0;
}

Match ScanMatcher::match(const Pose &guess,
                         const sensor_msgs::LaserScan &scan) const {
  Match match;
  match.pose = guess;
  const std::vector<Point> points = usable(scan);
  const int used = static_cast<int>(points.size());
  if (used < min_beams_)
    return match;
  for (int round = 0; round < Rounds; ++round) {
    const Step step = fit(match.pose, points);
    match.pose.x += step.dx;
    match.pose.y += step.dy;
    match.pose.yaw = wrapAngle(match.pose.yaw + step.dyaw);
    match.fit = step.weight / used;
    match.information = step.information;
  }
  match.accepted = plausible(guess, match);
  if (!match.accepted)
    match.pose = guess;
  return match;
}

std::vector<Point>
ScanMatcher::usable(const sensor_msgs::LaserScan &scan) const {
  std::vector<Point> points;
  for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam) {
    const double range = scan.ranges[beam];
    if (!std::isfinite(range))
      continue;
    const double angle =
        scan.angle_min + static_cast<double>(beam) * scan.angle_increment;
    points.push_back({range * std::cos(angle), range * std::sin(angle)});
  }
  return points;
}

ScanMatcher::Step ScanMatcher::fit(const Pose &pose,
                                   const std::vector<Point> &points) const {
  Step step;
  double a[3][3] = {}, b[3] = {};
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  for (const Point &point : points) {
    const double rx = c * point.x - s * point.y;
    const double ry = s * point.x + c * point.y;
    const Point in_map{pose.x + rx, pose.y + ry};
    const Nearest wall = nearestOnWalls(in_map);
    // Cauchy's weight: a point far from every wall is on a box, and says little.
    const double share = wall.distance / residual_scale_;
    const double weight = 1.0 / (1.0 + share * share);
    step.weight += weight;
    if (wall.distance < 1e-6)
      continue;
    const double nx = (wall.point.x - in_map.x) / wall.distance;
    const double ny = (wall.point.y - in_map.y) / wall.distance;
    const double row[3] = {nx, ny, -nx * ry + ny * rx};
    for (int i = 0; i < 3; ++i) {
      b[i] += weight * row[i] * wall.distance;
      for (int j = 0; j < 3; ++j)
        a[i][j] += weight * row[i] * row[j];
    }
  }
  step.information = std::min(a[0][0], a[1][1]);
  solve(a, b);
  step.dx = b[0];
  step.dy = b[1];
  step.dyaw = b[2];
  return step;
}

bool ScanMatcher::plausible(const Pose &guess, const Match &match) const {
  if (match.fit < min_fit_)
    return false;
  // Along a corridor nothing says how far the robot is.
  if (match.information < min_information_)
    return false;
  const double jump =
      std::hypot(match.pose.x - guess.x, match.pose.y - guess.y);
  if (jump > max_jump_)
    return false;
  const double turned = std::fabs(wrapAngle(match.pose.yaw - guess.yaw));
  return turned < max_jump_angle_;
}

} // namespace navigation
