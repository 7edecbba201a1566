#include "navigator.h"

#include <cmath>
#include <queue>

namespace heavy {

Planner::Planner(const ros::NodeHandle &handle, LayeredGrid &grid)
    : grid_(grid) {
  ros::NodeHandle own(handle, "planner");
  own.param("tolerance", tolerance_, 0.5);
  own.param("cost_weight", weight_, 0.6);
  own.param("neutral", neutral_, 50.0);
  own.param("timeout", timeout_, 2.0);
  own.param("most_expansions", most_, 100000);
  own.param("lethal", lethal_, 253);
  own.param("allow_unknown", allowUnknown_, true);
  own.param("smooth", smoothed_, true);
  publisher_ = own.advertise<nav_msgs::Path>("plan", 1);
}

bool Planner::search(const Cell &from, const Cell &to, std::vector<Cell> &out) {
  Grid &grid = grid_.grid();
  using Entry = std::pair<double, unsigned>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> open;
  std::unordered_map<unsigned, double> best;
  std::unordered_map<unsigned, unsigned> parent;
  unsigned start = from.y * grid.width() + from.x,
           goal = to.y * grid.width() + to.x;
  open.push({0, start});
  best[start] = 0;
  int expanded = 0;
  ros::WallTime begin = ros::WallTime::now();
  while (!open.empty()) {
    auto [estimate, here] = open.top();
    open.pop();
    if (here == goal) {
      for (unsigned at = goal; at != start; at = parent[at])
        out.push_back({at % grid.width(), at / grid.width()});
      std::reverse(out.begin(), out.end());
      return true;
    }
    if (++expanded > most_ || (ros::WallTime::now() - begin).toSec() > timeout_)
      return false;
    int x = here % grid.width(), y = here / grid.width();
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        int nx = x + dx, ny = y + dy;
        if ((!dx && !dy) || nx < 0 || ny < 0 || nx >= int(grid.width()) ||
            ny >= int(grid.height()))
          continue;
        unsigned char cost = grid.cost(nx, ny);
        if (cost == 255 ? !allowUnknown_ : cost >= lethal_)
          continue;
        double total =
            best[here] + std::hypot(dx, dy) * (neutral_ + weight_ * cost);
        unsigned next = ny * grid.width() + nx;
        auto known = best.find(next);
        if (known != best.end() && known->second <= total)
          continue;
        best[next] = total;
        parent[next] = here;
        open.push({total + neutral_ *
                               std::hypot(double(nx) - to.x, double(ny) - to.y),
                   next});
      }
  }
  return false;
}

void Planner::smooth(std::vector<geometry_msgs::PoseStamped> &path) const {
  for (size_t i = 1; i + 1 < path.size(); ++i) {
    path[i].pose.position.x =
        (path[i - 1].pose.position.x + path[i + 1].pose.position.x) / 2;
    path[i].pose.position.y =
        (path[i - 1].pose.position.y + path[i + 1].pose.position.y) / 2;
  }
}

bool Planner::plan(const geometry_msgs::PoseStamped &from,
                   const geometry_msgs::PoseStamped &to,
                   std::vector<geometry_msgs::PoseStamped> &out) {
  boost::unique_lock<boost::recursive_mutex> lock(grid_.grid().mutex());
  out.clear();
  Cell start, goal;
  if (!grid_.grid().toCell(from.pose.position.x, from.pose.position.y, start)) {
    ROS_WARN("the robot is outside of the map");
    return false;
  }
  double step = grid_.grid().resolution();
  std::vector<Cell> cells;
  bool found = false;
  for (double dy = -tolerance_; dy <= tolerance_ && !found; dy += step)
    for (double dx = -tolerance_; dx <= tolerance_ && !found; dx += step)
      if (grid_.grid().toCell(to.pose.position.x + dx, to.pose.position.y + dy,
                              goal))
        found = search(start, goal, cells);
  for (const Cell &cell : cells) {
    geometry_msgs::PoseStamped pose(to);
    grid_.grid().toWorld(cell, pose.pose.position.x, pose.pose.position.y);
    out.push_back(pose);
  }
  if (smoothed_)
    smooth(out);
  nav_msgs::Path path;
  path.poses = out;
  publisher_.publish(path);
  return found;
}

} // namespace heavy
