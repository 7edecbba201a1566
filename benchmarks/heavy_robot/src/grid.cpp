#include "grid.h"

#include <cmath>
#include <cstring>
#include <stdexcept>

namespace heavy {

Grid::Grid(unsigned width, unsigned height, double resolution)
    : width_(width), height_(height), resolution_(resolution),
      costs_(new unsigned char[width * height]) {
  fill(0);
}

Grid::~Grid() { delete[] costs_; }

bool Grid::toCell(double wx, double wy, Cell &cell) const {
  if (wx < originX_ || wy < originY_)
    return false;
  cell.x = static_cast<unsigned>((wx - originX_) / resolution_);
  cell.y = static_cast<unsigned>((wy - originY_) / resolution_);
  return cell.x < width_ && cell.y < height_;
}

void Grid::toWorld(const Cell &cell, double &wx, double &wy) const {
  wx = originX_ + (cell.x + 0.5) * resolution_;
  wy = originY_ + (cell.y + 0.5) * resolution_;
}

void Grid::fill(unsigned char cost) {
  boost::unique_lock<boost::recursive_mutex> lock(mutex_);
  std::memset(costs_, cost, width_ * height_);
}

void Grid::move(double x, double y) {
  int dx = static_cast<int>((x - originX_) / resolution_),
      dy = static_cast<int>((y - originY_) / resolution_);
  std::vector<unsigned char> kept(width_ * height_, 0);
  for (int j = 0; j < static_cast<int>(height_); ++j)
    for (int i = 0; i < static_cast<int>(width_); ++i) {
      int fromX = i + dx, fromY = j + dy;
      if (fromX >= 0 && fromY >= 0 && fromX < static_cast<int>(width_) &&
          fromY < static_cast<int>(height_))
        kept[j * width_ + i] = costs_[fromY * width_ + fromX];
    }
  std::copy(kept.begin(), kept.end(), costs_);
  originX_ += dx * resolution_;
  originY_ += dy * resolution_;
}

void Grid::line(const Cell &from, const Cell &to,
                const boost::function<void(unsigned, unsigned)> &visit) const {
  int dx = std::abs(static_cast<int>(to.x) - static_cast<int>(from.x));
  int dy = std::abs(static_cast<int>(to.y) - static_cast<int>(from.y));
  int stepX = from.x < to.x ? 1 : -1, stepY = from.y < to.y ? 1 : -1,
      error = dx - dy;
  int x = from.x, y = from.y;
  while (x != static_cast<int>(to.x) || y != static_cast<int>(to.y)) {
    visit(x, y);
    int twice = 2 * error;
    if (twice > -dy) {
      error -= dy;
      x += stepX;
    }
    if (twice < dx) {
      error += dx;
      y += stepY;
    }
  }
}

void Bounds::touch(double x, double y) {
  minX = std::min(minX, x);
  minY = std::min(minY, y);
  maxX = std::max(maxX, x);
  maxY = std::max(maxY, y);
}

void Layer::initialize(const ros::NodeHandle &parent, const std::string &name,
                       tf2_ros::Buffer *transforms) {
  handle_ = ros::NodeHandle(parent, name);
  name_ = name;
  transforms_ = transforms;
  handle_.param("enabled", enabled_, true);
  onInitialize();
}

static boost::shared_ptr<Layer> makeLayer(const std::string &type) {
  if (type == "static")
    return boost::make_shared<StaticLayer>();
  if (type == "obstacles")
    return boost::make_shared<ObstacleLayer>();
  if (type == "inflation")
    return boost::make_shared<InflationLayer>();
  throw std::runtime_error("no layer of type " + type);
}

LayeredGrid::LayeredGrid(const ros::NodeHandle &handle,
                         tf2_ros::Buffer &transforms)
    : handle_(handle), transforms_(transforms) {
  double width, height, resolution, rate, publishRate;
  handle_.param("width", width, 10.0);
  handle_.param("height", height, 10.0);
  handle_.param("resolution", resolution, 0.05);
  handle_.param("rolling", rolling_, false);
  handle_.param("tolerance", tolerance_, 0.3);
  handle_.param("update_rate", rate, 5.0);
  handle_.param("publish_rate", publishRate, 0.0);
  handle_.param("frame", frame_, std::string("map"));
  handle_.param("base", base_, std::string("base_link"));
  if (publishRate > 0)
    publishEvery_ = ros::Duration(1 / publishRate);
  else
    publishEvery_ = ros::Duration(-1);
  grid_ = boost::make_shared<Grid>(width / resolution, height / resolution,
                                   resolution);
  std::vector<std::string> names;
  if (!handle_.getParam("layers", names))
    names = {"static", "obstacles", "inflation"};
  for (const std::string &name : names) {
    boost::shared_ptr<Layer> layer = makeLayer(name);
    layer->initialize(handle_, name, &transforms_);
    layers_.push_back(layer);
  }
  publisher_ = handle_.advertise<nav_msgs::OccupancyGrid>("grid", 1, true);
  if (rate > 0)
    thread_ = new boost::thread(boost::bind(&LayeredGrid::loop, this, rate));
}

LayeredGrid::~LayeredGrid() {
  stop_ = true;
  if (thread_) {
    thread_->join();
    delete thread_;
  }
}

void LayeredGrid::loop(double rate) {
  ros::Rate every(rate);
  while (ros::ok() && !stop_) {
    ros::WallTime begin = ros::WallTime::now();
    update();
    if (publishEvery_ > ros::Duration(0) &&
        published_ + publishEvery_ < ros::Time::now()) {
      publish();
      published_ = ros::Time::now();
    }
    every.sleep();
    if (every.cycleTime() > ros::Duration(1 / rate))
      ROS_WARN("the grid misses its rate of %.1f Hz: %.3f s", rate,
               (ros::WallTime::now() - begin).toSec());
  }
}

bool LayeredGrid::pose(geometry_msgs::PoseStamped &out) const {
  try {
    geometry_msgs::TransformStamped found =
        transforms_.lookupTransform(frame_, base_, ros::Time());
    out.header = found.header;
    out.pose.position.x = found.transform.translation.x;
    out.pose.position.y = found.transform.translation.y;
    out.pose.orientation = found.transform.rotation;
  } catch (tf2::LookupException &e) {
    ROS_ERROR_THROTTLE(1.0, "no transform: %s", e.what());
    return false;
  } catch (tf2::ExtrapolationException &e) {
    ROS_ERROR_THROTTLE(1.0, "too old: %s", e.what());
    return false;
  }
  if ((ros::Time::now() - out.header.stamp).toSec() > tolerance_) {
    ROS_WARN_THROTTLE(1.0, "the pose is too old: %.2f s",
                      (ros::Time::now() - out.header.stamp).toSec());
    return false;
  }
  return true;
}

void LayeredGrid::update() {
  geometry_msgs::PoseStamped own;
  if (!pose(own))
    return;
  boost::unique_lock<boost::recursive_mutex> lock(grid_->mutex());
  double x = own.pose.position.x, y = own.pose.position.y;
  double yaw = 2 * std::atan2(own.pose.orientation.z, own.pose.orientation.w);
  if (rolling_)
    grid_->move(x - grid_->width() * grid_->resolution() / 2,
                y - grid_->height() * grid_->resolution() / 2);
  Bounds bounds;
  for (const auto &layer : layers_) {
    double before = bounds.minX;
    layer->updateBounds(x, y, yaw, bounds);
    if (bounds.minX > before)
      ROS_WARN("layer %s made the bounds smaller", layer->name().c_str());
  }
  for (auto layer = layers_.begin(); layer != layers_.end(); ++layer)
    (*layer)->updateCosts(*grid_, bounds);
}

bool LayeredGrid::isCurrent() const {
  bool current = true;
  for (const auto &layer : layers_)
    current = current && layer->isCurrent();
  return current;
}

void LayeredGrid::publish() {
  nav_msgs::OccupancyGrid message;
  message.header.frame_id = frame_;
  message.header.stamp = ros::Time::now();
  message.info.resolution = grid_->resolution();
  message.info.width = grid_->width();
  message.info.height = grid_->height();
  message.data.resize(message.info.width * message.info.height);
  for (unsigned y = 0; y < message.info.height; ++y)
    for (unsigned x = 0; x < message.info.width; ++x)
      message.data[y * message.info.width + x] = grid_->cost(x, y) * 100 / 254;
  publisher_.publish(message);
}

} // namespace heavy
