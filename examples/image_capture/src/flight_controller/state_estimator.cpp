#include "image_capture/state_estimator.h"

#include <cmath>

namespace image_capture {

StateEstimator::StateEstimator(ros::NodeHandle &private_nh) {
  private_nh.param("gps_enable_mode", gps_enable_mode_, true);
  private_nh.param("enable_baro_ctrl_mode", enable_baro_ctrl_mode_, true);
  private_nh.param("enable_derv_fir_filter", enable_derv_fir_filter_, true);
  private_nh.param("sonar_max_range", sonar_max_range_, 3.5);
  private_nh.param("flow_timeout", flow_timeout_, 3.0);
  private_nh.param("fix_report_age", fix_report_age_, 0.2);
  private_nh.param("height_filter_alpha", height_filter_alpha_, 0.5);
  height_filter_.setAlpha(height_filter_alpha_);
}

const Estimate &StateEstimator::update(const UavSensors &sensors) {
  estimate_.interval =
      last_stamp_.isZero() ? 0.0 : (sensors.header.stamp - last_stamp_).toSec();
  last_stamp_ = sensors.header.stamp;
  updateLateral(sensors);
  estimate_.z = height_filter_.update(heightFrom(sensors));
  estimate_.yaw = sensors.yaw;
  updateVelocity();
  return estimate_;
}

void StateEstimator::updateLateral(const UavSensors &sensors) {
  if (gps_enable_mode_ && sensors.gps_valid) {
    if ((sensors.header.stamp - last_fix_).toSec() > fix_report_age_)
      ++late_fixes_;
    last_fix_ = sensors.header.stamp;
    estimate_.x = sensors.gps_x;
    estimate_.y = sensors.gps_y;
    return;
  }
  // Dead reckoning drifts: after a while standing still is the better guess.
  if ((sensors.header.stamp - last_fix_).toSec() < flow_timeout_) {
    estimate_.x += sensors.flow_x * estimate_.interval;
    estimate_.y += sensors.flow_y * estimate_.interval;
  }
}

void StateEstimator::updateVelocity() {
  const double interval = estimate_.interval;
  if (enable_derv_fir_filter_) {
    estimate_.vx = fir_x_.update(estimate_.x, interval);
    estimate_.vy = fir_y_.update(estimate_.y, interval);
    estimate_.vz = fir_z_.update(estimate_.z, interval);
  } else {
    estimate_.vx = plain_x_.update(estimate_.x, interval);
    estimate_.vy = plain_y_.update(estimate_.y, interval);
    estimate_.vz = plain_z_.update(estimate_.z, interval);
  }
}

double StateEstimator::heightFrom(const UavSensors &sensors) const {
  if (enable_baro_ctrl_mode_)
    return sensors.baro_z;
  if (sensors.sonar_range > sonar_max_range_)
    return estimate_.z;
  // The sonar looks along the body's axis, not straight down.
  return sensors.sonar_range * std::cos(sensors.roll) * std::cos(sensors.pitch);
}

} // namespace image_capture
