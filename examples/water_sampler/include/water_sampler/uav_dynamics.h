// How the simulated UAV moves and what its sensors read.
#ifndef WATER_SAMPLER_UAV_DYNAMICS_H
#define WATER_SAMPLER_UAV_DYNAMICS_H

#include <cstdint>

#include <ros/ros.h>
#include <simulated_world/multirotor.h>
#include <simulated_world/noise.h>
#include <water_sampler/AttitudeCommand.h>
#include <water_sampler/UavSensors.h>

namespace water_sampler {

using UavState = simulated_world::MultirotorState;

class UavDynamics {
public:
  UavDynamics(ros::NodeHandle &private_nh, std::uint32_t seed);

  void step(const AttitudeCommand &command, double interval);
  /// `surface` is the height of the surface below the UAV, m.
  UavSensors sense(const ros::Time &stamp, double surface);
  const UavState &state() const { return multirotor_.state(); }

private:
  double voltage() const;
  simulated_world::Wind wind() const;

  simulated_world::Noise noise_;
  simulated_world::SlowNoise gust_x_{0.03, 2.0};
  simulated_world::SlowNoise gust_y_{0.03, 2.0};
  simulated_world::SlowNoise baro_drift_{0.02, 20.0};
  simulated_world::Multirotor multirotor_;
  double charge_ = 1.0; ///< of the battery, 0 to 1
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
