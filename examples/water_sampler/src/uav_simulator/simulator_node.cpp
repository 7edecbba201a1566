#include "water_sampler/simulator_node.h"

#include <geometry_msgs/PoseStamped.h>
#include <simulated_world/truth.h>
#include <std_msgs/Float64.h>

namespace water_sampler {

namespace {
constexpr double TruthPeriod = 0.1;
constexpr double WaterPeriod = 0.05;
} // namespace

SimulatorNode::SimulatorNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh,
                             std::uint32_t seed)
    : clock_(nh), dynamics_(private_nh, seed), water_(seed + 1000u) {
  private_nh.param("rate", rate_, 4.0);
  private_nh.param("sensor_period", sensor_period_, 0.06);
  private_nh.param("sampler_period", sampler_period_, 0.1);
  private_nh.param("max_command_lag", max_command_lag_, 0.12);
  sensors_pub_ = nh.advertise<UavSensors>("/uav/sensors", 10);
  sampler_pub_ = nh.advertise<SamplerSensors>("/sampler/sensors", 10);
  uav_truth_pub_ = nh.advertise<geometry_msgs::PoseStamped>("/truth/uav", 100);
  sampler_truth_pub_ = nh.advertise<SamplerTruth>("/truth/sampler", 100);
  filled_pub_ = nh.advertise<std_msgs::Float64>("/truth/vial_filled", 2, true);
  command_sub_ = nh.subscribe("/uav/command", 10, &SimulatorNode::onCommand,
                              this, ros::TransportHints().tcpNoDelay());
  drive_sub_ = nh.subscribe("/pump/drive", 10, &SimulatorNode::onDrive, this,
                            ros::TransportHints().tcpNoDelay());
  waypose_sub_ = nh.subscribe("/mission/waypose", 10, &SimulatorNode::onWayPose,
                              this, ros::TransportHints().tcpNoDelay());
}

void SimulatorNode::run(ros::NodeHandle &private_nh) {
  double max_duration = 600.0;
  private_nh.getParam("max_duration", max_duration);
  waitForPilot();
  while (ros::ok()) {
    ros::spinOnce();
    if (clock_.every(1.0) && clock_.now() > max_duration)
      break;
    tick();
    controller_.hold(max_command_lag_);
    mission_.hold(max_command_lag_);
    pump_.hold(max_command_lag_);
    clock_.keepPace(rate_);
  }
}

void SimulatorNode::waitForPilot() {
  // The time begins when other nodes read the UAV and the pump, and the mission
  // has begun.
  while (ros::ok() && (sensors_pub_.getNumSubscribers() < 2 ||
                       sampler_pub_.getNumSubscribers() == 0 ||
                       waypose_sub_.getNumPublishers() == 0)) {
    ros::WallDuration(0.02).sleep();
    ros::spinOnce();
  }
}

void SimulatorNode::tick() {
  clock_.advance();
  const ros::Time stamp = clock_.stamp();
  dynamics_.step(command_, clock_.Step);
  const UavState &uav = dynamics_.state();
  if (clock_.every(WaterPeriod))
    water_.step(uav, drive_, WaterPeriod);
  if (clock_.every(sensor_period_)) {
    // The mission answers the controller, which passes on the stamp.
    controller_.sent(stamp);
    mission_.sent(stamp);
    sensors_pub_.publish(
        dynamics_.sense(stamp, water_.surfaceBelow(uav.x, uav.y)));
  }
  if (clock_.every(sampler_period_)) {
    pump_.sent(stamp);
    sampler_pub_.publish(water_.sense(stamp));
  }
  if (clock_.every(TruthPeriod))
    publishTruth();
}

void SimulatorNode::onCommand(const AttitudeCommand &command) {
  command_ = command;
  controller_.answered(command.header.stamp);
}

void SimulatorNode::onWayPose(const WayPose &waypose) {
  mission_.answered(waypose.header.stamp);
}

void SimulatorNode::onDrive(const PumpDrive &drive) {
  drive_ = drive;
  pump_.answered(drive.header.stamp);
}

void SimulatorNode::publishTruth() {
  const UavState &uav = dynamics_.state();
  const ros::Time stamp = clock_.stamp();
  uav_truth_pub_.publish(
      simulated_world::poseAt(stamp, uav.x, uav.y, uav.z, uav.yaw));
  const SamplerTruth sampler = water_.truth(stamp);
  sampler_truth_pub_.publish(sampler);
  if (filled_ || !water_.vialFilled())
    return;
  filled_ = true;
  std_msgs::Float64 level;
  level.data = sampler.vial_level;
  filled_pub_.publish(level);
}

} // namespace water_sampler
