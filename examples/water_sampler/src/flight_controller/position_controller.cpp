#include <cmath>

#include "water_sampler/axis_controllers.h"

namespace water_sampler {

namespace {
constexpr double PositionGain = 0.7;
constexpr double VelocityGain = 0.22;
} // namespace

PositionController::PositionController(ros::NodeHandle &private_nh) {
  private_nh.param("cruise_speed", cruise_speed_, 1.0);
  private_nh.param("max_velocity", max_velocity_, 1.5);
  private_nh.param("max_tilt", max_tilt_, 0.3);
  private_nh.param("tilt_deadband", tilt_deadband_, 0.002);
  private_nh.param("enable_position_ctrl", enable_position_ctrl_, true);
}

Tilt PositionController::update(const Estimate &estimate,
                                const Target &target) {
  Tilt tilt;
  if (!enable_position_ctrl_)
    return tilt;
  advanceSetpoint(target, estimate.interval);
  double vx = PositionGain * (setpoint_x_ - estimate.x);
  double vy = PositionGain * (setpoint_y_ - estimate.y);
  const double speed = std::hypot(vx, vy);
  if (speed > max_velocity_) {
    vx *= max_velocity_ / speed;
    vy *= max_velocity_ / speed;
  }
  tilt.pitch = tiltFor(vx - estimate.vx);
  tilt.roll = tiltFor(vy - estimate.vy);
  return tilt;
}

void PositionController::reset(const Estimate &estimate) {
  setpoint_x_ = estimate.x;
  setpoint_y_ = estimate.y;
}

void PositionController::advanceSetpoint(const Target &target,
                                         double interval) {
  const double dx = target.x - setpoint_x_;
  const double dy = target.y - setpoint_y_;
  const double distance = std::hypot(dx, dy);
  const double step = cruise_speed_ * interval;
  const double share = distance > step ? step / distance : 1.0;
  setpoint_x_ += share * dx;
  setpoint_y_ += share * dy;
}

double PositionController::tiltFor(double error) const {
  const double tilt = VelocityGain * error;
  if (std::fabs(tilt) > max_tilt_)
    return std::copysign(max_tilt_, tilt);
  if (std::fabs(tilt) < tilt_deadband_)
    return 0.0;
  return tilt;
}

} // namespace water_sampler
