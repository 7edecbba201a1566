#include "grid.h"

#include <boost/bind/bind.hpp>

#include <cmath>

using namespace boost::placeholders;

namespace heavy {

ObservationBuffer::ObservationBuffer(const std::string &topic, double keep,
                                     double rate, double lowest, double highest,
                                     double range)
    : topic_(topic), keep_(keep), expected_(rate), last_(ros::Time::now()),
      lowest_(lowest), highest_(highest), range_(range) {}

void ObservationBuffer::add(const sensor_msgs::LaserScan &scan,
                            const geometry_msgs::Pose &pose) {
  boost::mutex::scoped_lock lock(mutex_);
  observations_.push_front(Observation());
  Observation &seen = observations_.front();
  seen.stamp = scan.header.stamp;
  seen.origin = pose.position;
  seen.range = range_;
  double yaw = 2 * std::atan2(pose.orientation.z, pose.orientation.w),
         angle = scan.angle_min;
  for (std::vector<float>::const_iterator r = scan.ranges.begin();
       r != scan.ranges.end(); ++r) {
    if (*r >= scan.range_min && *r < scan.range_max && *r < range_) {
      geometry_msgs::Point point;
      point.x = pose.position.x + *r * std::cos(yaw + angle);
      point.y = pose.position.y + *r * std::sin(yaw + angle);
      point.z = pose.position.z;
      if (point.z <= highest_ && point.z >= lowest_)
        seen.points.push_back(point);
    }
    angle += scan.angle_increment;
  }
  last_ = ros::Time::now();
  forgetOld();
}

void ObservationBuffer::forgetOld() {
  if (observations_.empty())
    return;
  if (keep_ == ros::Duration(0)) {
    observations_.erase(++observations_.begin(), observations_.end());
    return;
  }
  for (std::list<Observation>::iterator it = observations_.begin();
       it != observations_.end(); ++it)
    if (last_ - it->stamp > keep_) {
      observations_.erase(it, observations_.end());
      return;
    }
}

void ObservationBuffer::read(std::vector<Observation> &out) {
  boost::mutex::scoped_lock lock(mutex_);
  forgetOld();
  std::copy(observations_.begin(), observations_.end(),
            std::back_inserter(out));
}

bool ObservationBuffer::isCurrent() const {
  if (expected_ == ros::Duration(0))
    return true;
  bool current = (ros::Time::now() - last_).toSec() <= expected_.toSec();
  if (!current)
    ROS_WARN("%s has not been updated for %.2f seconds", topic_.c_str(),
             (ros::Time::now() - last_).toSec());
  return current;
}

void StaticLayer::onInitialize() {
  std::string topic;
  handle_.param("topic", topic, std::string("map"));
  handle_.param("track_unknown", unknown_, true);
  handle_.param("occupied", occupied_, 65);
  handle_.param("unknown_value", unknownValue_, -1);
  ros::NodeHandle global;
  subscriber_ = global.subscribe(topic, 1, &StaticLayer::onMap, this);
}

void StaticLayer::onMap(const nav_msgs::OccupancyGridConstPtr &map) {
  map_ = map;
  received_ = true;
}

unsigned char StaticLayer::translate(signed char value) const {
  if (unknown_ && value == unknownValue_)
    return 255;
  if (value >= occupied_)
    return 254;
  return 0;
}

void StaticLayer::updateBounds(double, double, double, Bounds &bounds) {
  if (!received_ || !enabled_)
    return;
  bounds.touch(map_->info.origin.position.x, map_->info.origin.position.y);
  bounds.touch(
      map_->info.origin.position.x + map_->info.width * map_->info.resolution,
      map_->info.origin.position.y + map_->info.height * map_->info.resolution);
}

void StaticLayer::updateCosts(Grid &grid, const Bounds &bounds) {
  if (!received_ || !enabled_)
    return;
  for (unsigned y = 0; y < map_->info.height; ++y)
    for (unsigned x = 0; x < map_->info.width; ++x) {
      double wx = map_->info.origin.position.x + x * map_->info.resolution;
      double wy = map_->info.origin.position.y + y * map_->info.resolution;
      Cell cell;
      if (wx < bounds.minX || wx > bounds.maxX || !grid.toCell(wx, wy, cell))
        continue;
      grid.set(cell.x, cell.y, translate(map_->data[y * map_->info.width + x]));
    }
}

void ObstacleLayer::onInitialize() {
  std::vector<std::string> sources;
  handle_.param("highest", highest_, 2.0);
  handle_.param("footprint", footprint_, 0.3);
  handle_.param("combination", combination_, 1);
  if (!handle_.getParam("sources", sources))
    sources.push_back("scan");
  ros::NodeHandle global;
  for (const std::string &source : sources) {
    ros::NodeHandle own(handle_, source);
    std::string topic;
    double keep, rate, lowest, highest, range;
    own.param("topic", topic, source);
    own.param("keep", keep, 0.0);
    own.param("expected_rate", rate, 0.0);
    own.param("lowest", lowest, 0.0);
    own.param("highest", highest, 2.0);
    own.param("range", range, 2.5);
    buffers_.push_back(boost::make_shared<ObservationBuffer>(
        topic, keep, rate, lowest, highest, range));
    subscribers_.push_back(global.subscribe<sensor_msgs::LaserScan>(
        topic, 50,
        boost::bind(&ObstacleLayer::onScan, this, _1, buffers_.back())));
  }
  server_ = boost::make_shared<
      dynamic_reconfigure::Server<dynamic_reconfigure_test::TestConfig>>(
      handle_);
  server_->setCallback(boost::bind(&ObstacleLayer::onChange, this, _1, _2));
}

void ObstacleLayer::onChange(dynamic_reconfigure_test::TestConfig &config,
                             uint32_t) {
  enabled_ = config.bool_;
  highest_ = config.double_;
  combination_ = config.int_;
}

void ObstacleLayer::onScan(const sensor_msgs::LaserScanConstPtr &scan,
                           const boost::shared_ptr<ObservationBuffer> &buffer) {
  buffer->add(*scan, pose_);
}

void ObstacleLayer::clear(const Observation &seen, Bounds &bounds) {
  for (const geometry_msgs::Point &point : seen.points) {
    double dx = point.x - seen.origin.x, dy = point.y - seen.origin.y,
           distance = std::hypot(dx, dy);
    if (distance > seen.range) {
      dx *= seen.range / distance;
      dy *= seen.range / distance;
    }
    bounds.touch(seen.origin.x + dx, seen.origin.y + dy);
    cleared_[std::make_pair(static_cast<unsigned>(point.x * 20),
                            static_cast<unsigned>(point.y * 20))] = 0;
  }
}

void ObstacleLayer::updateBounds(double x, double y, double yaw,
                                 Bounds &bounds) {
  pose_.position.x = x;
  pose_.position.y = y;
  pose_.orientation.z = std::sin(yaw / 2);
  pose_.orientation.w = std::cos(yaw / 2);
  if (!enabled_)
    return;
  std::vector<Observation> all;
  for (const auto &buffer : buffers_)
    buffer->read(all);
  for (const Observation &seen : all) {
    clear(seen, bounds);
    for (const geometry_msgs::Point &point : seen.points) {
      if (point.z > highest_)
        continue;
      double dx = point.x - x, dy = point.y - y;
      if (dx * dx + dy * dy < footprint_ * footprint_)
        continue;
      bounds.touch(point.x, point.y);
      marked_[std::make_pair(static_cast<unsigned>(point.x * 20),
                             static_cast<unsigned>(point.y * 20))] = 254;
    }
  }
}

void ObstacleLayer::updateCosts(Grid &grid, const Bounds &) {
  if (!enabled_)
    return;
  for (const auto &entry : cleared_)
    if (entry.first.first < grid.width() && entry.first.second < grid.height())
      grid.set(entry.first.first, entry.first.second, entry.second);
  for (const auto &[where, cost] : marked_) {
    if (where.first >= grid.width() || where.second >= grid.height())
      continue;
    unsigned char old = grid.cost(where.first, where.second);
    if (combination_ == 0 || old < cost)
      grid.set(where.first, where.second, cost);
  }
}

bool ObstacleLayer::isCurrent() const {
  for (const auto &buffer : buffers_)
    if (!buffer->isCurrent())
      return false;
  return true;
}

void InflationLayer::onInitialize() {
  handle_.param("radius", radius_, 0.5);
  handle_.param("scaling", scaling_, 10.0);
  handle_.param("inscribed", inscribed_, 0.2);
}

void InflationLayer::updateBounds(double, double, double, Bounds &bounds) {
  if (last_ != radius_) {
    bounds.touch(-1e10, -1e10);
    bounds.touch(1e10, 1e10);
    last_ = radius_;
  }
  bounds.touch(bounds.minX - radius_, bounds.minY - radius_);
  bounds.touch(bounds.maxX + radius_, bounds.maxY + radius_);
}

void InflationLayer::computeCosts(double resolution) {
  unsigned size = static_cast<unsigned>(radius_ / resolution) + 2;
  costs_.assign(size, std::vector<unsigned char>(size, 0));
  for (unsigned y = 0; y < size; ++y)
    for (unsigned x = 0; x < size; ++x) {
      double distance = std::hypot(x, y) * resolution;
      if (distance == 0)
        costs_[y][x] = 254;
      else if (distance <= inscribed_)
        costs_[y][x] = 253;
      else
        costs_[y][x] = static_cast<unsigned char>(
            252 * std::exp(-scaling_ * (distance - inscribed_)));
    }
}

void InflationLayer::enqueue(const Grid &grid, unsigned x, unsigned y,
                             unsigned fromX, unsigned fromY) {
  if (seen_[y * grid.width() + x])
    return;
  double distance =
      std::hypot(double(x) - fromX, double(y) - fromY) * grid.resolution();
  if (distance > radius_)
    return;
  queue_[distance].push_back({x, y, fromX, fromY});
}

void InflationLayer::updateCosts(Grid &grid, const Bounds &) {
  if (!enabled_ || radius_ == 0)
    return;
  if (costs_.empty())
    computeCosts(grid.resolution());
  seen_.assign(grid.width() * grid.height(), false);
  for (unsigned y = 0; y < grid.height(); ++y)
    for (unsigned x = 0; x < grid.width(); ++x)
      if (grid.cost(x, y) == 254)
        queue_[0].push_back({x, y, x, y});
  for (auto bin = queue_.begin(); bin != queue_.end(); ++bin)
    for (size_t i = 0; i < bin->second.size(); ++i) {
      const Step step = bin->second[i];
      if (seen_[step.y * grid.width() + step.x])
        continue;
      seen_[step.y * grid.width() + step.x] = true;
      unsigned dx = std::abs(int(step.x) - int(step.fromX)),
               dy = std::abs(int(step.y) - int(step.fromY));
      if (dx < costs_.size() && dy < costs_.size() &&
          costs_[dy][dx] > grid.cost(step.x, step.y))
        grid.set(step.x, step.y, costs_[dy][dx]);
      if (step.x > 0)
        enqueue(grid, step.x - 1, step.y, step.fromX, step.fromY);
      if (step.y > 0)
        enqueue(grid, step.x, step.y - 1, step.fromX, step.fromY);
      if (step.x + 1 < grid.width())
        enqueue(grid, step.x + 1, step.y, step.fromX, step.fromY);
      if (step.y + 1 < grid.height())
        enqueue(grid, step.x, step.y + 1, step.fromX, step.fromY);
    }
  queue_.clear();
}

} // namespace heavy
