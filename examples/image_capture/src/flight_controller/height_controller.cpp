#include <algorithm>
#include <cmath>

#include "image_capture/axis_controllers.h"

namespace image_capture {

namespace {
constexpr double HeightGain = 1.2;
constexpr double ClimbGain = 0.16;
constexpr double IntegralGain = 0.04;
// The barometer is slower and noisier than the sonar.
constexpr double BaroGainShare = 0.8;
} // namespace

HeightController::HeightController(ros::NodeHandle &private_nh) {
  private_nh.param("hover_thrust", hover_thrust_, 0.5);
  private_nh.param("max_climb_rate", max_climb_rate_, 0.8);
  private_nh.param("min_thrust", min_thrust_, 0.3);
  private_nh.param("max_thrust", max_thrust_, 0.75);
  private_nh.param("thrust_integral_limit", thrust_integral_limit_, 0.1);
  private_nh.param("enable_thrust_ctrl", enable_thrust_ctrl_, true);
  private_nh.param("enable_thrust_iir_filter", enable_thrust_iir_filter_, true);
  private_nh.param("enable_baro_ctrl_mode", enable_baro_ctrl_mode_, true);
}

double HeightController::update(const Estimate &estimate,
                                const Target &target) {
  if (!enable_thrust_ctrl_)
    return hover_thrust_;
  const double wanted = climbRate(target.z - estimate.z);
  const double error = wanted - estimate.vz;
  const double gain =
      enable_baro_ctrl_mode_ ? BaroGainShare * ClimbGain : ClimbGain;
  integral_ =
      clampMagnitude(integral_ + IntegralGain * error * estimate.interval,
                     thrust_integral_limit_);
  double thrust = hover_thrust_ + gain * error + integral_;
  if (thrust < min_thrust_)
    thrust = min_thrust_;
  else if (thrust > max_thrust_)
    thrust = max_thrust_;
  return enable_thrust_iir_filter_ ? thrust_filter_.update(thrust) : thrust;
}

double HeightController::climbRate(double error) const {
  const double rate = HeightGain * error;
  return std::fabs(rate) > max_climb_rate_
             ? std::copysign(max_climb_rate_, rate)
             : rate;
}

void HeightController::reset() {
  integral_ = 0.0;
  thrust_filter_.reset();
}

} // namespace image_capture
