// Position and velocity from the UAV's sensors.
#ifndef WATER_SAMPLER_STATE_ESTIMATOR_H
#define WATER_SAMPLER_STATE_ESTIMATOR_H

#include <ros/ros.h>
#include <water_sampler/UavSensors.h>

#include "water_sampler/filters.h"

namespace water_sampler {

/// World frame, m and m/s.
struct Estimate {
  double x = 0.0, y = 0.0, z = 0.0;
  double vx = 0.0, vy = 0.0, vz = 0.0;
  double interval = 0.0; ///< since the last sensor message, s
  bool near_ground = true;
};

class StateEstimator {
public:
  explicit StateEstimator(ros::NodeHandle &private_nh);

  const Estimate &update(const UavSensors &sensors);
  const Estimate &estimate() const { return estimate_; }
  unsigned oddSteps() const { return odd_steps_; }

private:
  void updateLateral(const UavSensors &sensors);
  double height(const UavSensors &sensors);

  Estimate estimate_;
  ros::Time last_stamp_;
  ros::Time last_fix_;
  Slope slope_x_{0.35}, slope_y_{0.35}, slope_z_{0.35};
  LowPass height_filter_{0.5};
  double gps_timeout_;
  double near_ground_range_;
  double odd_step_;
  bool enable_height_filter_;
  unsigned odd_steps_ = 0;
};

} // namespace water_sampler

#endif // WATER_SAMPLER_STATE_ESTIMATOR_H
