#include "navigator.h"

#include <boost/bind/bind.hpp>

#include <cmath>

using namespace boost::placeholders;

namespace heavy {

Navigator::Navigator(tf2_ros::Buffer &transforms)
    : handle_("~"), global_(ros::NodeHandle("~/global"), transforms),
      local_(ros::NodeHandle("~/local"), transforms),
      localiser_(handle_, global_, broadcaster_), planner_(handle_, global_),
      controller_(handle_, local_),
      server_(handle_, "go", boost::bind(&Navigator::run, this, _1), false) {
  double planner, controller, oscillation;
  handle_.param("planner_patience", planner, 5.0);
  handle_.param("controller_patience", controller, 15.0);
  handle_.param("oscillation_timeout", oscillation, 0.0);
  handle_.param("oscillation_distance", distance_, 0.5);
  handle_.param("controller_frequency", frequency_, 20.0);
  handle_.param("planning_retries", retries_, -1);
  handle_.param("recovery_enabled", recovery_, true);
  plannerPatience_ = ros::Duration(planner);
  controllerPatience_ = ros::Duration(controller);
  oscillation_ = ros::Duration(oscillation);
  recoveries_["clear"] = [this] {
    local_.grid().fill(0);
    return true;
  };
  recoveries_["turn"] = [this] {
    geometry_msgs::Twist turn;
    turn.angular.z = 1;
    velocity_.publish(turn);
    return local_.isCurrent();
  };
  if (!handle_.getParam("recoveries", order_))
    order_ = {"clear", "turn"};
  velocity_ = handle_.advertise<geometry_msgs::Twist>("/cmd_vel", 1);
  status_ = handle_.advertise<geometry_msgs::PoseStamped>("goal", 1);
  ros::NodeHandle global;
  subscribers_.push_back(
      global.subscribe("odom", 10, &Localiser::onOdometry, &localiser_));
  subscribers_.push_back(
      global.subscribe("scan", 10, &Localiser::onScan, &localiser_));
  server_.start();
}

bool Navigator::recover() {
  if (!recovery_ || next_ >= order_.size())
    return false;
  auto found = recoveries_.find(order_[next_++]);
  return found != recoveries_.end() && found->second();
}

void Navigator::run(const actionlib::TestGoalConstPtr &goal) {
  geometry_msgs::PoseStamped target, oscillationPose, pose;
  target.pose.position.x = goal->goal;
  target.pose.orientation.w = 1;
  status_.publish(target);
  state_ = Planning;
  next_ = 0;
  int tried = 0;
  ros::Rate rate(frequency_);
  ros::Time lastPlan = ros::Time::now(), lastControl = lastPlan,
            lastMove = lastPlan;
  std::vector<geometry_msgs::PoseStamped> plan;
  geometry_msgs::Twist command;
  while (ros::ok()) {
    if (server_.isPreemptRequested()) {
      velocity_.publish(geometry_msgs::Twist());
      server_.setPreempted();
      return;
    }
    if (!local_.isCurrent() || !local_.pose(pose)) {
      velocity_.publish(geometry_msgs::Twist());
      rate.sleep();
      continue;
    }
    double moved =
        std::hypot(pose.pose.position.x - oscillationPose.pose.position.x,
                   pose.pose.position.y - oscillationPose.pose.position.y);
    if (moved >= distance_) {
      lastMove = ros::Time::now();
      oscillationPose = pose;
    }
    switch (state_) {
    case Planning:
      if (planner_.plan(pose, target, plan)) {
        controller_.setPlan(plan);
        lastPlan = lastControl = ros::Time::now();
        tried = 0;
        state_ = Controlling;
      } else if (ros::Time::now() > lastPlan + plannerPatience_ ||
                 (retries_ >= 0 && ++tried > retries_)) {
        state_ = Recovering;
        velocity_.publish(geometry_msgs::Twist());
      }
      break;
    case Controlling:
      if (controller_.isReached(pose, command)) {
        velocity_.publish(geometry_msgs::Twist());
        server_.setSucceeded();
        return;
      }
      if (oscillation_ > ros::Duration(0) &&
          lastMove + oscillation_ < ros::Time::now()) {
        state_ = Recovering;
        break;
      }
      if (controller_.velocity(pose, command, command)) {
        lastControl = ros::Time::now();
        velocity_.publish(command);
      } else if (ros::Time::now() > lastControl + controllerPatience_) {
        state_ = Recovering;
      } else {
        state_ = Planning;
      }
      break;
    case Recovering:
      if (!recover()) {
        server_.setAborted(actionlib::TestResult(), "no way was found");
        return;
      }
      state_ = Planning;
      lastPlan = ros::Time::now();
      break;
    }
    rate.sleep();
    if (rate.cycleTime() > ros::Duration(1 / frequency_))
      ROS_WARN("the control loop misses its rate of %.1f Hz", frequency_);
  }
}

} // namespace heavy
