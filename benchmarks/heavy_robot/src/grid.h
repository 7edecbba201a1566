// A grid of costs that layers write to, in the manner of robots that people
// drive.
#pragma once

#include <boost/function.hpp>
#include <boost/shared_ptr.hpp>
#include <boost/thread.hpp>
#include <dynamic_reconfigure/TestConfig.h>
#include <dynamic_reconfigure/server.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/PoseStamped.h>
#include <nav_msgs/OccupancyGrid.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_ros/buffer.h>

#include <deque>
#include <list>
#include <map>
#include <string>
#include <vector>

namespace heavy {

struct Cell {
  unsigned x, y;
};

class Grid {
public:
  Grid(unsigned width, unsigned height, double resolution);
  ~Grid();
  Grid(const Grid &) = delete;
  Grid &operator=(const Grid &) = delete;

  bool toCell(double wx, double wy, Cell &cell) const;
  void toWorld(const Cell &cell, double &wx, double &wy) const;
  void move(double x, double y);
  void fill(unsigned char cost);
  unsigned char cost(unsigned x, unsigned y) const {
    return costs_[y * width_ + x];
  }
  void set(unsigned x, unsigned y, unsigned char cost) {
    costs_[y * width_ + x] = cost;
  }
  void line(const Cell &from, const Cell &to,
            const boost::function<void(unsigned, unsigned)> &visit) const;
  unsigned width() const { return width_; }
  unsigned height() const { return height_; }
  double resolution() const { return resolution_; }
  boost::recursive_mutex &mutex() { return mutex_; }

private:
  unsigned width_, height_;
  double resolution_, originX_ = 0, originY_ = 0;
  unsigned char *costs_;
  boost::recursive_mutex mutex_;
};

struct Bounds {
  double minX = 1e30, minY = 1e30, maxX = -1e30, maxY = -1e30;
  void touch(double x, double y);
};

class Layer {
public:
  virtual ~Layer() {}
  void initialize(const ros::NodeHandle &parent, const std::string &name,
                  tf2_ros::Buffer *transforms);
  virtual void updateBounds(double x, double y, double yaw, Bounds &bounds) = 0;
  virtual void updateCosts(Grid &grid, const Bounds &bounds) = 0;
  virtual bool isCurrent() const { return true; }
  const std::string &name() const { return name_; }

protected:
  virtual void onInitialize() = 0;
  ros::NodeHandle handle_;
  std::string name_;
  tf2_ros::Buffer *transforms_ = nullptr;
  bool enabled_ = true;
};

struct Observation {
  ros::Time stamp;
  geometry_msgs::Point origin;
  std::vector<geometry_msgs::Point> points;
  double range;
};

class ObservationBuffer {
public:
  ObservationBuffer(const std::string &topic, double keep, double rate,
                    double lowest, double highest, double range);
  void add(const sensor_msgs::LaserScan &scan, const geometry_msgs::Pose &pose);
  void read(std::vector<Observation> &out);
  bool isCurrent() const;

private:
  void forgetOld();
  std::string topic_;
  std::list<Observation> observations_;
  ros::Duration keep_, expected_;
  ros::Time last_;
  double lowest_, highest_, range_;
  mutable boost::mutex mutex_;
};

class StaticLayer : public Layer {
public:
  void updateBounds(double x, double y, double yaw, Bounds &bounds) override;
  void updateCosts(Grid &grid, const Bounds &bounds) override;

private:
  void onInitialize() override;
  void onMap(const nav_msgs::OccupancyGridConstPtr &map);
  unsigned char translate(signed char value) const;
  ros::Subscriber subscriber_;
  nav_msgs::OccupancyGridConstPtr map_;
  bool unknown_ = true, received_ = false;
  int occupied_ = 65, unknownValue_ = -1;
};

class ObstacleLayer : public Layer {
public:
  void updateBounds(double x, double y, double yaw, Bounds &bounds) override;
  void updateCosts(Grid &grid, const Bounds &bounds) override;
  bool isCurrent() const override;

private:
  void onInitialize() override;
  void onScan(const sensor_msgs::LaserScanConstPtr &scan,
              const boost::shared_ptr<ObservationBuffer> &buffer);
  void onChange(dynamic_reconfigure_test::TestConfig &config, uint32_t level);
  void clear(const Observation &seen, Bounds &bounds);
  std::vector<boost::shared_ptr<ObservationBuffer>> buffers_;
  std::vector<ros::Subscriber> subscribers_;
  boost::shared_ptr<
      dynamic_reconfigure::Server<dynamic_reconfigure_test::TestConfig>>
      server_;
  std::map<std::pair<unsigned, unsigned>, unsigned char> marked_, cleared_;
  geometry_msgs::Pose pose_;
  double highest_ = 2, footprint_ = 0.3;
  int combination_ = 1;
};

class InflationLayer : public Layer {
public:
  void updateBounds(double x, double y, double yaw, Bounds &bounds) override;
  void updateCosts(Grid &grid, const Bounds &bounds) override;

private:
  void onInitialize() override;
  void computeCosts(double resolution);
  struct Step {
    unsigned x, y, fromX, fromY;
  };
  void enqueue(const Grid &grid, unsigned x, unsigned y, unsigned fromX,
               unsigned fromY);
  std::map<double, std::vector<Step>> queue_;
  std::vector<std::vector<unsigned char>> costs_;
  std::vector<bool> seen_;
  double radius_ = 0.5, scaling_ = 10, inscribed_ = 0.2, last_ = 0;
};

class LayeredGrid {
public:
  LayeredGrid(const ros::NodeHandle &handle, tf2_ros::Buffer &transforms);
  ~LayeredGrid();
  void update();
  bool isCurrent() const;
  bool pose(geometry_msgs::PoseStamped &out) const;
  Grid &grid() { return *grid_; }

private:
  void loop(double rate);
  void publish();
  ros::NodeHandle handle_;
  tf2_ros::Buffer &transforms_;
  std::vector<boost::shared_ptr<Layer>> layers_;
  boost::shared_ptr<Grid> grid_;
  boost::thread *thread_ = nullptr;
  ros::Publisher publisher_;
  ros::Duration publishEvery_;
  ros::Time published_;
  std::string frame_, base_;
  double tolerance_ = 0.3;
  bool rolling_ = false, stop_ = false;
};

} // namespace heavy
