// How the simulated UAV moves and what its sensors read.
#ifndef IMAGE_CAPTURE_UAV_DYNAMICS_H
#define IMAGE_CAPTURE_UAV_DYNAMICS_H

#include <cstdint>

#include <image_capture/AttitudeCommand.h>
#include <image_capture/UavSensors.h>
#include <ros/ros.h>
#include <simulated_world/multirotor.h>
#include <simulated_world/noise.h>

namespace image_capture {

using UavState = simulated_world::MultirotorState;

class UavDynamics {
public:
  UavDynamics(ros::NodeHandle &private_nh, std::uint32_t seed);

  void step(const AttitudeCommand &command, double interval);
  UavSensors sense(const ros::Time &stamp);
  const UavState &state() const { return multirotor_.state(); }

private:
  double voltage() const;

  simulated_world::Noise noise_;
  simulated_world::SlowNoise gust_x_{0.0, 2.0};
  simulated_world::SlowNoise gust_y_{0.0, 2.0};
  simulated_world::SlowNoise baro_drift_{0.03, 20.0};
  simulated_world::Multirotor multirotor_;
  double charge_ = 1.0; ///< of the battery, 0 to 1
  double battery_seconds_;
  double battery_empty_voltage_;
  double gps_dropout_;
  bool enable_wind_;
  bool battery_empty_ = false;
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_UAV_DYNAMICS_H
