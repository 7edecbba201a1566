#include "water_sampler/controller_node.h"

#include <water_sampler/AttitudeCommand.h>
#include <water_sampler/FlightState.h>

namespace water_sampler {

namespace {
constexpr double SilentStep = 0.3; // m
} // namespace

ControllerNode::ControllerNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh)
    : estimator_(private_nh), position_controller_(private_nh),
      height_controller_(private_nh), safety_(nh, private_nh) {
  private_nh.param("waypose_idle_timeout", waypose_idle_timeout_, 4.0);
  command_pub_ = nh.advertise<AttitudeCommand>("/uav/command", 10);
  state_pub_ = nh.advertise<FlightState>("/controller/state", 10);
  waypose_sub_ =
      nh.subscribe("/mission/waypose", 10, &ControllerNode::onWayPose, this);
  sensors_sub_ = nh.subscribe("/uav/sensors", 10, &ControllerNode::onSensors,
                              this, ros::TransportHints().tcpNoDelay());
  housekeeping_timer_ =
      nh.createTimer(ros::Duration(0.5), &ControllerNode::onHousekeeping, this);
}

void ControllerNode::onWayPose(const WayPose &waypose) {
  if (waypose.motors_on && !motors_on_) {
    height_controller_.reset();
    position_controller_.reset(estimator_.estimate());
  }
  motors_on_ = waypose.motors_on;
  target_.x = waypose.position.x;
  target_.y = waypose.position.y;
  target_.z = waypose.position.z;
  last_waypose_ = ros::Time::now();
}

void ControllerNode::onHousekeeping(const ros::TimerEvent &event) {
  const double age = (event.current_real - last_waypose_).toSec();
  waypose_fresh_ = age < waypose_idle_timeout_;
  if (!safety_.check(estimator_.estimate(), battery_voltage_,
                     event.current_real))
    aborting_ = true;
  ROS_DEBUG("%u odd steps of the GPS", estimator_.oddSteps());
}

void ControllerNode::onSensors(const UavSensors &sensors) {
  estimator_.update(sensors);
  battery_voltage_ = sensors.battery_voltage;
  // Without a mission it sinks to the ground where it is.
  if (!waypose_fresh_)
    target_.z = estimator_.estimate().z - SilentStep;
  publishCommand(sensors.header.stamp);
  publishState(sensors.header.stamp);
}

void ControllerNode::publishCommand(const ros::Time &stamp) {
  AttitudeCommand command;
  command.header.stamp = stamp;
  command.motors_on = motors_on_;
  if (motors_on_) {
    const Estimate &estimate = estimator_.estimate();
    const Tilt tilt = position_controller_.update(estimate, target_);
    command.roll = tilt.roll;
    command.pitch = tilt.pitch;
    command.thrust = height_controller_.update(estimate, target_);
  }
  command_pub_.publish(command);
}

void ControllerNode::publishState(const ros::Time &stamp) {
  const Estimate &estimate = estimator_.estimate();
  FlightState state;
  state.header.stamp = stamp;
  state.position.x = estimate.x;
  state.position.y = estimate.y;
  state.position.z = estimate.z;
  state.velocity.x = estimate.vx;
  state.velocity.y = estimate.vy;
  state.velocity.z = estimate.vz;
  state.battery_voltage = battery_voltage_;
  state.motors_on = motors_on_;
  state.idle = !waypose_fresh_;
  state.near_ground = estimate.near_ground;
  state.aborting = aborting_;
  state_pub_.publish(state);
}

} // namespace water_sampler
