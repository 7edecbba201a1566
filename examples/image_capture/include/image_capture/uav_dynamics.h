// How the simulated UAV moves and what its sensors read.
#ifndef IMAGE_CAPTURE_UAV_DYNAMICS_H
#define IMAGE_CAPTURE_UAV_DYNAMICS_H

#include <cstdint>

#include <image_capture/AttitudeCommand.h>
#include <image_capture/UavSensors.h>
#include <ros/ros.h>

#include "image_capture/noise.h"

namespace image_capture {

/// World frame, m, m/s, rad.
struct UavState {
  double x = 0.0, y = 0.0, z = 0.0;
  double vx = 0.0, vy = 0.0, vz = 0.0;
  double roll = 0.0, pitch = 0.0, yaw = 0.0, yaw_rate = 0.0;
  double thrust = 0.0;
  double charge = 1.0; ///< of the battery, 0 to 1
};

class UavDynamics {
public:
  UavDynamics(ros::NodeHandle &private_nh, std::uint32_t seed);

  void step(const AttitudeCommand &command, double interval);
  UavSensors sense(const ros::Time &stamp);
  const UavState &state() const { return state_; }

private:
  double voltage() const;
  void moveSideways(double interval);
  void moveUp(double interval);

  Noise noise_;
  SlowNoise gust_x_{0.0, 2.0};
  SlowNoise gust_y_{0.0, 2.0};
  SlowNoise baro_drift_{0.03, 20.0};
  UavState state_;
  double battery_seconds_;
  double battery_empty_voltage_;
  double gps_dropout_;
  bool enable_wind_;
  bool battery_empty_ = false;
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_UAV_DYNAMICS_H
