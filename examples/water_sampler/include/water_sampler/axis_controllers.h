// The controllers of the flight controller node, one per group of axes.
#ifndef WATER_SAMPLER_AXIS_CONTROLLERS_H
#define WATER_SAMPLER_AXIS_CONTROLLERS_H

#include <ros/ros.h>

#include "water_sampler/filters.h"
#include "water_sampler/state_estimator.h"

namespace water_sampler {

/// Where the UAV should be. World frame, m.
struct Target {
  double x = 0.0, y = 0.0, z = 0.0;
};

/// rad.
struct Tilt {
  double roll = 0.0, pitch = 0.0;
};

/// Roll and pitch from the error in x and y.
class PositionController {
public:
  explicit PositionController(ros::NodeHandle &private_nh);

  Tilt update(const Estimate &estimate, const Target &target);
  /// Starts from where the UAV is.
  void reset(const Estimate &estimate);

private:
  void advanceSetpoint(const Target &target, double interval);
  double tiltFor(double error) const;

  double setpoint_x_ = 0.0;
  double setpoint_y_ = 0.0;
  double cruise_speed_;
  double max_velocity_;
  double max_tilt_;
  double tilt_deadband_;
  bool enable_position_ctrl_;
};

/// Thrust from the error in z.
class HeightController {
public:
  explicit HeightController(ros::NodeHandle &private_nh);

  double update(const Estimate &estimate, const Target &target);
  void reset();

private:
  double climbRate(double error) const;
  void integrate(double error, double interval);

  LowPass thrust_filter_{0.6};
  double hover_thrust_;
  double max_climb_rate_;
  double max_sink_rate_;
  double min_thrust_;
  double max_thrust_;
  double max_thrust_trim_;
  double trim_ = 0.0;
  bool enable_thrust_filter_;
};

} // namespace water_sampler

#endif // WATER_SAMPLER_AXIS_CONTROLLERS_H
