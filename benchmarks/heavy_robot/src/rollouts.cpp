#include "navigator.h"

#include <cmath>
#include <limits>

namespace heavy {

namespace {

class ObstacleCritic : public Critic {
public:
  ObstacleCritic(LayeredGrid &grid, double radius)
      : grid_(grid), radius_(radius) {}
  double score(const Rollout &rollout) const override {
    double worst = 0;
    for (const Particle &p : rollout.poses)
      for (double angle = 0; angle < 2 * M_PI; angle += 0.5) {
        Cell cell;
        if (!grid_.grid().toCell(p.x + radius_ * std::cos(angle),
                                 p.y + radius_ * std::sin(angle), cell))
          return -2;
        unsigned char cost = grid_.grid().cost(cell.x, cell.y);
        if (cost >= 253)
          return -1;
        worst = std::max(worst, double(cost));
      }
    return worst;
  }

private:
  LayeredGrid &grid_;
  double radius_;
};

class PathCritic : public Critic {
public:
  explicit PathCritic(double limit) : limit_(limit) {}
  void prepare(const std::vector<geometry_msgs::PoseStamped> &plan) override {
    plan_ = plan;
  }
  double score(const Rollout &rollout) const override {
    double nearest = std::numeric_limits<double>::max();
    const Particle &last = rollout.poses.back();
    for (const auto &pose : plan_)
      nearest = std::min(nearest, std::hypot(pose.pose.position.x - last.x,
                                             pose.pose.position.y - last.y));
    return nearest > limit_ ? -3 : nearest;
  }

private:
  std::vector<geometry_msgs::PoseStamped> plan_;
  double limit_;
};

class TurningCritic : public Critic {
public:
  double score(const Rollout &rollout) const override {
    return std::fabs(rollout.w);
  }
};

} // namespace

Controller::Controller(const ros::NodeHandle &handle, LayeredGrid &grid)
    : server_(ros::NodeHandle(handle, "controller")) {
  ros::NodeHandle own(handle, "controller");
  own.param("max_v", maxV_, 0.5);
  own.param("min_v", minV_, 0.1);
  own.param("max_w", maxW_, 1.0);
  own.param("accel_v", accelV_, 2.5);
  own.param("accel_w", accelW_, 3.2);
  own.param("horizon", horizon_, 1.7);
  own.param("step", step_, 0.05);
  own.param("xy_tolerance", xyTolerance_, 0.1);
  own.param("yaw_tolerance", yawTolerance_, 0.05);
  own.param("stopped_v", stoppedV_, 0.1);
  own.param("stopped_w", stoppedW_, 0.1);
  own.param("samples_v", samplesV_, 3);
  own.param("samples_w", samplesW_, 20);
  own.param("latch", latch_, false);
  double radius, limit, obstacles, path, turning;
  own.param("radius", radius, 0.2);
  own.param("path_limit", limit, 2.0);
  own.param("obstacle_scale", obstacles, 0.01);
  own.param("path_scale", path, 32.0);
  own.param("turning_scale", turning, 1.0);
  critics_.push_back(std::make_unique<ObstacleCritic>(grid, radius));
  critics_.back()->scale = obstacles;
  critics_.push_back(std::make_unique<PathCritic>(limit));
  critics_.back()->scale = path;
  critics_.push_back(std::make_unique<TurningCritic>());
  critics_.back()->scale = turning;
  server_.setCallback([this](dynamic_reconfigure_test::TestConfig &config,
                             uint32_t level) { onChange(config, level); });
}

void Controller::onChange(dynamic_reconfigure_test::TestConfig &config,
                          uint32_t) {
  boost::mutex::scoped_lock lock(mutex_);
  if (config.double_ > 0)
    maxV_ = config.double_;
  samplesV_ = std::max(1, config.int_);
  latch_ = config.bool_;
}

void Controller::roll(Rollout &rollout,
                      const geometry_msgs::PoseStamped &pose) const {
  Particle p{pose.pose.position.x, pose.pose.position.y,
             2 * std::atan2(pose.pose.orientation.z, pose.pose.orientation.w),
             1};
  for (double t = 0; t < horizon_; t += step_) {
    p.x += rollout.v * std::cos(p.yaw) * step_;
    p.y += rollout.v * std::sin(p.yaw) * step_;
    p.yaw += rollout.w * step_;
    rollout.poses.push_back(p);
  }
}

bool Controller::velocity(const geometry_msgs::PoseStamped &pose,
                          const geometry_msgs::Twist &now,
                          geometry_msgs::Twist &out) {
  boost::mutex::scoped_lock lock(mutex_);
  for (const auto &critic : critics_)
    critic->prepare(plan_);
  double low = std::max(minV_, now.linear.x - accelV_ * horizon_);
  double high = std::min(maxV_, now.linear.x + accelV_ * horizon_);
  double left = std::min(maxW_, now.angular.z + accelW_ * horizon_);
  Rollout best;
  for (int i = 0; i < samplesV_; ++i)
    for (int j = 0; j < samplesW_; ++j) {
      Rollout rollout;
      rollout.v = low + (high - low) * i / std::max(1, samplesV_ - 1);
      rollout.w = -left + 2 * left * j / std::max(1, samplesW_ - 1);
      if (std::fabs(rollout.v) < stoppedV_ && std::fabs(rollout.w) < stoppedW_)
        continue;
      roll(rollout, pose);
      if (rollout.poses.empty())
        continue;
      double total = 0;
      for (const auto &critic : critics_) {
        double score = critic->score(rollout);
        if (score < 0) {
          total = score;
          break;
        }
        total += critic->scale * score;
        if (best.cost >= 0 && total > best.cost)
          break;
      }
      if (total >= 0 && (best.cost < 0 || total < best.cost)) {
        rollout.cost = total;
        best = rollout;
      }
    }
  if (best.cost < 0)
    return false;
  out.linear.x = best.v;
  out.angular.z = best.w;
  return true;
}

bool Controller::isReached(const geometry_msgs::PoseStamped &pose,
                           const geometry_msgs::Twist &now) const {
  if (plan_.empty())
    return false;
  const geometry_msgs::PoseStamped &goal = plan_.back();
  double distance = std::hypot(goal.pose.position.x - pose.pose.position.x,
                               goal.pose.position.y - pose.pose.position.y);
  if (distance > xyTolerance_ && !(latch_ && latched_))
    return false;
  latched_ = true;
  double yaw = 2 * (std::asin(goal.pose.orientation.z) -
                    std::asin(pose.pose.orientation.z));
  return std::fabs(yaw) <= yawTolerance_ &&
         std::fabs(now.linear.x) < stoppedV_ &&
         std::fabs(now.angular.z) < stoppedW_;
}

} // namespace heavy
