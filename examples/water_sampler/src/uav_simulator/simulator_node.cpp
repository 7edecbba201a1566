#include "water_sampler/simulator_node.h"

#include <cmath>

#include <geometry_msgs/PoseStamped.h>
#include <rosgraph_msgs/Clock.h>
#include <std_msgs/Float64.h>

namespace water_sampler {

namespace {
constexpr double TruthPeriod = 0.1;
constexpr double WaterPeriod = 0.05;
/// A controller that is gone must not stop the time for good.
constexpr double LongestHold = 0.5;
} // namespace

SimulatorNode::SimulatorNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh,
                             std::uint32_t seed)
    : dynamics_(private_nh, seed), water_(seed + 1000u) {
  private_nh.param("rate", rate_, 4.0);
  private_nh.param("sensor_period", sensor_period_, 0.06);
  private_nh.param("sampler_period", sampler_period_, 0.1);
  private_nh.param("max_command_lag", max_command_lag_, 0.12);
  clock_pub_ = nh.advertise<rosgraph_msgs::Clock>("/clock", 50);
  sensors_pub_ = nh.advertise<UavSensors>("/uav/sensors", 10);
  sampler_pub_ = nh.advertise<SamplerSensors>("/sampler/sensors", 10);
  uav_truth_pub_ = nh.advertise<geometry_msgs::PoseStamped>("/truth/uav", 20);
  sampler_truth_pub_ = nh.advertise<SamplerTruth>("/truth/sampler", 20);
  filled_pub_ = nh.advertise<std_msgs::Float64>("/truth/vial_filled", 2, true);
  command_sub_ = nh.subscribe("/uav/command", 10, &SimulatorNode::onCommand,
                              this, ros::TransportHints().tcpNoDelay());
  drive_sub_ = nh.subscribe("/pump/drive", 10, &SimulatorNode::onDrive, this);
}

void SimulatorNode::run(ros::NodeHandle &private_nh) {
  double max_duration = 600.0;
  private_nh.getParam("max_duration", max_duration);
  waitForPilot();
  ros::WallTime next = ros::WallTime::now();
  while (ros::ok()) {
    ros::spinOnce();
    if (every(1.0) && now() > max_duration)
      break;
    tick();
    waitForController();
    next += ros::WallDuration(Step / rate_);
    const ros::WallTime now = ros::WallTime::now();
    if (next > now)
      (next - now).sleep();
    else if ((now - next).toSec() > 0.05)
      next = now; // too slow to keep up: lose time, do not rush
  }
}

void SimulatorNode::waitForPilot() {
  // The time begins when the UAV and the pump have someone who reads them.
  while (ros::ok() && (sensors_pub_.getNumSubscribers() < 2 ||
                       sampler_pub_.getNumSubscribers() == 0)) {
    ros::WallDuration(0.02).sleep();
    ros::spinOnce();
  }
}

void SimulatorNode::tick() {
  ++ticks_;
  dynamics_.step(command_, Step);
  const UavState &uav = dynamics_.state();
  if (every(WaterPeriod))
    water_.step(uav, drive_, WaterPeriod);
  rosgraph_msgs::Clock clock;
  clock.clock = stamp();
  clock_pub_.publish(clock);
  if (every(sensor_period_)) {
    sensor_ticks_ = ticks_;
    sensors_pub_.publish(
        dynamics_.sense(stamp(), water_.surfaceBelow(uav.x, uav.y)));
  }
  if (every(sampler_period_))
    sampler_pub_.publish(water_.sense(stamp()));
  if (every(TruthPeriod))
    publishTruth();
}

void SimulatorNode::waitForController() {
  if (command_ticks_ < 0 || sensor_ticks_ != ticks_)
    return;
  // On a busy machine the time waits for the controller, so that the flight
  // does not depend on the load.
  double held = 0.0;
  while (ros::ok() && held < LongestHold) {
    const auto lag = static_cast<double>(sensor_ticks_ - command_ticks_);
    if (lag * Step <= max_command_lag_)
      return;
    ros::WallDuration(0.001).sleep();
    held += 0.001;
    ros::spinOnce();
  }
}

void SimulatorNode::onCommand(const AttitudeCommand &command) {
  command_ = command;
  command_ticks_ = static_cast<std::int64_t>(
      std::llround(command.header.stamp.toSec() / Step));
}

void SimulatorNode::publishTruth() {
  const UavState &uav = dynamics_.state();
  geometry_msgs::PoseStamped pose;
  pose.header.stamp = stamp();
  pose.header.frame_id = "map";
  pose.pose.position.x = uav.x;
  pose.pose.position.y = uav.y;
  pose.pose.position.z = uav.z;
  pose.pose.orientation.w = 1.0;
  uav_truth_pub_.publish(pose);
  const SamplerTruth sampler = water_.truth(stamp());
  sampler_truth_pub_.publish(sampler);
  if (filled_ || !water_.vialFilled())
    return;
  filled_ = true;
  std_msgs::Float64 level;
  level.data = sampler.vial_level;
  filled_pub_.publish(level);
}

ros::Time SimulatorNode::stamp() const {
  const std::int64_t milliseconds = ticks_ * 10;
  return ros::Time(static_cast<std::uint32_t>(milliseconds / 1000),
                   static_cast<std::uint32_t>(milliseconds % 1000) * 1000000u);
}

bool SimulatorNode::every(double seconds) const {
  return ticks_ % std::llround(seconds / Step) == 0;
}

} // namespace water_sampler
