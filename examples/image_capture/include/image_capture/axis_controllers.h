// The controllers of the flight controller node, one per group of axes.
#ifndef IMAGE_CAPTURE_AXIS_CONTROLLERS_H
#define IMAGE_CAPTURE_AXIS_CONTROLLERS_H

#include <ros/ros.h>

#include "image_capture/filters.h"
#include "image_capture/limits.h"
#include "image_capture/state_estimator.h"

namespace image_capture {

/// Where the UAV should be. World frame, m and rad.
struct Target {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  double yaw = 0.0;
  double yaw_rate = 0.0;
  bool turn = false; ///< yaw_rate holds instead of yaw
};

/// Body frame, rad.
struct Tilt {
  double roll = 0.0;
  double pitch = 0.0;
};

/// Roll and pitch from the error in x and y.
class PositionController {
public:
  explicit PositionController(ros::NodeHandle &private_nh);

  Tilt update(const Estimate &estimate, const Target &target);
  /// Starts from where the UAV is.
  void reset(const Estimate &estimate);
  bool lateralControl() const;

private:
  void advanceSetpoint(const Target &target, double interval);
  double axis(double error) const;

  double position_gain_ = 0.7;
  double velocity_gain_ = 0.22;
  double setpoint_x_ = 0.0;
  double setpoint_y_ = 0.0;
  double cruise_speed_;
  double max_velocity_;
  double max_tilt_;
  double stick_deadband_;
  bool enable_pitch_ctrl_;
  bool enable_roll_ctrl_;
  bool collapse_deadband_;
};

/// Thrust from the error in z.
class HeightController {
public:
  explicit HeightController(ros::NodeHandle &private_nh);

  double update(const Estimate &estimate, const Target &target);
  void reset();

private:
  double climbRate(double error) const;

  IirLowPass thrust_filter_{0.6};
  double hover_thrust_;
  double max_climb_rate_;
  double min_thrust_;
  double max_thrust_;
  double thrust_integral_limit_;
  double integral_ = 0.0;
  bool enable_thrust_ctrl_;
  bool enable_thrust_iir_filter_;
  bool enable_baro_ctrl_mode_;
};

/// Yaw rate from the error in yaw, or the requested rate.
class YawController {
public:
  explicit YawController(ros::NodeHandle &private_nh);

  double update(const Estimate &estimate, const Target &target);
  bool enabled() const { return enable_yaw_ctrl_; }

private:
  SlewLimiter slew_;
  double yaw_gain_ = 2.0;
  double max_yaw_rate_;
  double max_yaw_acceleration_;
  bool enable_yaw_ctrl_;
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_AXIS_CONTROLLERS_H
