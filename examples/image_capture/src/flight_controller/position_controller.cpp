#include <cmath>

#include "image_capture/axis_controllers.h"

namespace image_capture {

PositionController::PositionController(ros::NodeHandle &private_nh) {
  private_nh.param("cruise_speed", cruise_speed_, 1.0);
  private_nh.param("max_velocity", max_velocity_, 1.5);
  private_nh.param("max_tilt", max_tilt_, 0.35);
  private_nh.param("stick_deadband", stick_deadband_, 0.004);
  private_nh.param("enable_pitch_ctrl", enable_pitch_ctrl_, true);
  private_nh.param("enable_roll_ctrl", enable_roll_ctrl_, true);
  private_nh.param("collapse_deadband", collapse_deadband_, true);
}

Tilt PositionController::update(const Estimate &estimate,
                                const Target &target) {
  advanceSetpoint(target, estimate.interval);
  double vx = position_gain_ * (setpoint_x_ - estimate.x);
  double vy = position_gain_ * (setpoint_y_ - estimate.y);
  const double speed = std::hypot(vx, vy);
  if (speed > max_velocity_) {
    vx *= max_velocity_ / speed;
    vy *= max_velocity_ / speed;
  }
  const double c = std::cos(estimate.yaw);
  const double s = std::sin(estimate.yaw);
  const double error_x = vx - estimate.vx;
  const double error_y = vy - estimate.vy;

  Tilt tilt;
  if (enable_pitch_ctrl_)
    tilt.pitch = axis(c * error_x + s * error_y);
  if (enable_roll_ctrl_)
    tilt.roll = axis(-s * error_x + c * error_y);
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

double PositionController::axis(double error) const {
  double tilt = velocity_gain_ * error;
  if (std::fabs(tilt) > max_tilt_)
    tilt = std::copysign(max_tilt_, tilt);
  const double width = collapse_deadband_ ? stick_deadband_ : 0.0;
  return applyDeadband(tilt, width, collapse_deadband_);
}

bool PositionController::lateralControl() const {
  return enable_pitch_ctrl_ && enable_roll_ctrl_;
}

} // namespace image_capture
