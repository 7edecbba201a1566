// How the simulated UAV moves and what its sensors read.
#ifndef WATER_SAMPLER_UAV_DYNAMICS_H
#define WATER_SAMPLER_UAV_DYNAMICS_H

#include <cstdint>

#include <ros/ros.h>
#include <water_sampler/AttitudeCommand.h>
#include <water_sampler/UavSensors.h>

#include "water_sampler/noise.h"

namespace water_sampler {

/// World frame, m, m/s, rad.
struct UavState {
  double x = 0.0, y = 0.0, z = 0.0;
  double vx = 0.0, vy = 0.0, vz = 0.0;
  double roll = 0.0, pitch = 0.0;
  double thrust = 0.0;
  double charge = 1.0; ///< of the battery, 0 to 1
};

class UavDynamics {
public:
  UavDynamics(ros::NodeHandle &private_nh, std::uint32_t seed);

  void step(const AttitudeCommand &command, double interval);
  /// `surface` is the height of what is below the UAV, m.
  UavSensors sense(const ros::Time &stamp, double surface);
  const UavState &state() const { return state_; }

private:
  double voltage() const;
  void moveSideways(double interval);
  void moveUp(double interval);

  Noise noise_;
  Drift gust_x_{0.03, 2.0};
  Drift gust_y_{0.03, 2.0};
  Drift baro_drift_{0.02, 20.0};
  UavState state_;
  double wind_x_;
  double wind_y_;
  double battery_seconds_;
  double battery_empty_voltage_;
  double gps_dropout_;
  bool enable_wind_;
  bool battery_empty_ = false;
};

} // namespace water_sampler

#endif // WATER_SAMPLER_UAV_DYNAMICS_H
