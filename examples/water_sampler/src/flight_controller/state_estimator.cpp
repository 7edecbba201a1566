#include "water_sampler/state_estimator.h"

#include <cmath>

namespace water_sampler {

StateEstimator::StateEstimator(ros::NodeHandle &private_nh) {
  private_nh.param("gps_timeout", gps_timeout_, 1.0);
  private_nh.param("near_ground_range", near_ground_range_, 0.15);
  private_nh.param("odd_step", odd_step_, 0.2);
  private_nh.param("enable_height_filter", enable_height_filter_, true);
}

const Estimate &StateEstimator::update(const UavSensors &sensors) {
  estimate_.interval =
      last_stamp_.isZero() ? 0.0 : (sensors.header.stamp - last_stamp_).toSec();
  last_stamp_ = sensors.header.stamp;
  updateLateral(sensors);
  estimate_.z = height(sensors);
  estimate_.vz = slope_z_.update(estimate_.z, estimate_.interval);
  estimate_.near_ground = sensors.sonar_range < near_ground_range_;
  return estimate_;
}

void StateEstimator::updateLateral(const UavSensors &sensors) {
  if (sensors.gps_valid) {
    if (std::fabs(sensors.gps_x - estimate_.x) > odd_step_)
      ++odd_steps_;
    last_fix_ = sensors.header.stamp;
    estimate_.x = sensors.gps_x;
    estimate_.y = sensors.gps_y;
  }
  estimate_.vx = slope_x_.update(estimate_.x, estimate_.interval);
  estimate_.vy = slope_y_.update(estimate_.y, estimate_.interval);
  // An old fix says nothing about the speed: do not control by it.
  if ((sensors.header.stamp - last_fix_).toSec() > gps_timeout_)
    estimate_.vx = estimate_.vy = 0.0;
}

double StateEstimator::height(const UavSensors &sensors) {
  if (enable_height_filter_)
    return height_filter_.update(sensors.baro_z);
  return sensors.baro_z;
}

} // namespace water_sampler
