#include "water_sampler/axis_controllers.h"

namespace water_sampler {

namespace {
constexpr double HeightGain = 1.2;
constexpr double ClimbGain = 0.13;
constexpr double TrimGain = 0.04;
} // namespace

HeightController::HeightController(ros::NodeHandle &private_nh) {
  private_nh.param("hover_thrust", hover_thrust_, 0.5);
  private_nh.param("max_climb_rate", max_climb_rate_, 0.8);
  private_nh.param("max_sink_rate", max_sink_rate_, 0.6);
  private_nh.param("min_thrust", min_thrust_, 0.3);
  private_nh.param("max_thrust", max_thrust_, 0.75);
  private_nh.param("max_thrust_trim", max_thrust_trim_, 0.1);
  private_nh.param("enable_thrust_filter", enable_thrust_filter_, true);
}

double HeightController::update(const Estimate &estimate,
                                const Target &target) {
  const double error = climbRate(target.z - estimate.z) - estimate.vz;
  // On the ground the error says nothing about the thrust.
  if (!estimate.near_ground)
    integrate(error, estimate.interval);
  double thrust = hover_thrust_ + ClimbGain * error + trim_;
  if (thrust < min_thrust_)
    thrust = min_thrust_;
  else if (thrust > max_thrust_)
    thrust = max_thrust_;
  return enable_thrust_filter_ ? thrust_filter_.update(thrust) : thrust;
}

double HeightController::climbRate(double error) const {
  const double rate = HeightGain * error;
  if (rate > max_climb_rate_)
    return max_climb_rate_;
  return rate < -max_sink_rate_ ? -max_sink_rate_ : rate;
}

void HeightController::integrate(double error, double interval) {
  trim_ += TrimGain * error * interval;
  if (trim_ > max_thrust_trim_)
    trim_ = max_thrust_trim_;
  else if (trim_ < -max_thrust_trim_)
    trim_ = -max_thrust_trim_;
}

void HeightController::reset() {
  trim_ = 0.0;
  thrust_filter_.reset();
}

} // namespace water_sampler
