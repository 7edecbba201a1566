// What drives the robot: a localiser, a planner, a controller, and the action
// that uses them.
#pragma once

#include "grid.h"

#include <actionlib/TestAction.h>
#include <actionlib/server/simple_action_server.h>
#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/Twist.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <tf2_ros/transform_broadcaster.h>
#include <tf2_ros/transform_listener.h>

#include <memory>
#include <random>
#include <set>
#include <unordered_map>

namespace heavy {

struct Particle {
  double x, y, yaw, weight;
};

class Localiser {
public:
  Localiser(const ros::NodeHandle &handle, LayeredGrid &grid,
            tf2_ros::TransformBroadcaster &out);
  void onOdometry(const nav_msgs::Odometry &odometry);
  void onScan(const sensor_msgs::LaserScanConstPtr &scan);

private:
  void predict(double forward, double turn);
  double fit(const Particle &p, const sensor_msgs::LaserScan &scan) const;
  void resample();
  double spread() const;
  LayeredGrid &grid_;
  tf2_ros::TransformBroadcaster &out_;
  ros::Publisher cloud_, mean_;
  std::vector<Particle> particles_;
  std::default_random_engine random_;
  nav_msgs::Odometry last_;
  bool started_ = false;
  double alpha1_, alpha2_, hit_, noise_, range_, updateD_, updateA_, recover_,
      moved_ = 0, turned_ = 0;
  int most_, least_, every_, count_ = 0;
  std::string model_;
};

class Planner {
public:
  Planner(const ros::NodeHandle &handle, LayeredGrid &grid);
  bool plan(const geometry_msgs::PoseStamped &from,
            const geometry_msgs::PoseStamped &to,
            std::vector<geometry_msgs::PoseStamped> &out);

private:
  bool search(const Cell &from, const Cell &to, std::vector<Cell> &out);
  void smooth(std::vector<geometry_msgs::PoseStamped> &path) const;
  LayeredGrid &grid_;
  ros::Publisher publisher_;
  double tolerance_, weight_, neutral_, timeout_;
  int most_, lethal_;
  bool allowUnknown_, smoothed_;
};

struct Rollout {
  double v, w, cost = -1;
  std::vector<Particle> poses;
};

class Critic {
public:
  virtual ~Critic() {}
  virtual void prepare(const std::vector<geometry_msgs::PoseStamped> &) {}
  virtual double score(const Rollout &rollout) const = 0;
  double scale = 1;
};

class Controller {
public:
  Controller(const ros::NodeHandle &handle, LayeredGrid &grid);
  void setPlan(const std::vector<geometry_msgs::PoseStamped> &plan) {
    plan_ = plan;
  }
  bool velocity(const geometry_msgs::PoseStamped &pose,
                const geometry_msgs::Twist &now, geometry_msgs::Twist &out);
  bool isReached(const geometry_msgs::PoseStamped &pose,
                 const geometry_msgs::Twist &now) const;

private:
  void onChange(dynamic_reconfigure_test::TestConfig &config, uint32_t level);
  void roll(Rollout &rollout, const geometry_msgs::PoseStamped &pose) const;
  std::vector<std::unique_ptr<Critic>> critics_;
  std::vector<geometry_msgs::PoseStamped> plan_;
  dynamic_reconfigure::Server<dynamic_reconfigure_test::TestConfig> server_;
  boost::mutex mutex_;
  double maxV_, minV_, maxW_, accelV_, accelW_, horizon_, step_, xyTolerance_,
      yawTolerance_, stoppedV_, stoppedW_;
  int samplesV_, samplesW_;
  bool latch_;
  mutable bool latched_ = false;
};

class Navigator {
public:
  explicit Navigator(tf2_ros::Buffer &transforms);
  void run(const actionlib::TestGoalConstPtr &goal);

private:
  enum State { Planning, Controlling, Recovering };
  bool recover();
  ros::NodeHandle handle_;
  LayeredGrid global_, local_;
  tf2_ros::TransformBroadcaster broadcaster_;
  Localiser localiser_;
  Planner planner_;
  Controller controller_;
  actionlib::SimpleActionServer<actionlib::TestAction> server_;
  ros::Publisher velocity_, status_;
  std::vector<ros::Subscriber> subscribers_;
  std::map<std::string, boost::function<bool()>> recoveries_;
  std::vector<std::string> order_;
  State state_ = Planning;
  ros::Duration plannerPatience_, controllerPatience_, oscillation_;
  double frequency_, distance_;
  int retries_;
  bool recovery_;
  size_t next_ = 0;
};

} // namespace heavy
