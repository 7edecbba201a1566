#include "water_sampler/uav_dynamics.h"

#include <cmath>

namespace water_sampler {

namespace {
constexpr double FullVoltage = 12.5;
constexpr double EmptyVoltage = 10.2;
} // namespace

UavDynamics::UavDynamics(ros::NodeHandle &private_nh, std::uint32_t seed)
    : noise_(seed) {
  private_nh.param("wind_x", wind_x_, 0.12);
  private_nh.param("wind_y", wind_y_, 0.08);
  private_nh.param("battery_seconds", battery_seconds_, 600.0);
  private_nh.param("battery_empty_voltage", battery_empty_voltage_, 10.3);
  private_nh.param("gps_dropout", gps_dropout_, 0.005);
  private_nh.param("enable_wind", enable_wind_, true);
}

void UavDynamics::step(const AttitudeCommand &command, double interval) {
  const bool powered = command.motors_on && !battery_empty_;
  gust_x_.step(noise_, interval);
  gust_y_.step(noise_, interval);
  baro_drift_.step(noise_, interval);
  // The UAV keeps its heading by itself.
  multirotor_.step(
      {command.roll, command.pitch, 0.0, powered ? command.thrust : 0.0},
      wind(), interval);
  charge_ -= state().thrust * interval / battery_seconds_;
}

simulated_world::Wind UavDynamics::wind() const {
  if (!enable_wind_)
    return {};
  return {wind_x_ + gust_x_.value(), wind_y_ + gust_y_.value()};
}

double UavDynamics::voltage() const {
  const double sag = 0.4 * state().thrust;
  return EmptyVoltage + (FullVoltage - EmptyVoltage) * charge_ - sag;
}

UavSensors UavDynamics::sense(const ros::Time &stamp, double surface) {
  battery_empty_ = voltage() < battery_empty_voltage_;
  const UavState &uav = state();
  UavSensors sensors;
  sensors.header.stamp = stamp;
  sensors.gps_x = uav.x + noise_.gaussian(0.008);
  sensors.gps_y = uav.y + noise_.gaussian(0.008);
  sensors.gps_valid = !noise_.chance(gps_dropout_);
  sensors.baro_z = uav.z + baro_drift_.value() + noise_.gaussian(0.02);
  const double slant = std::cos(uav.roll) * std::cos(uav.pitch);
  sensors.sonar_range = (uav.z - surface) / slant + noise_.gaussian(0.01);
  sensors.roll = uav.roll + noise_.gaussian(0.003);
  sensors.pitch = uav.pitch + noise_.gaussian(0.003);
  sensors.battery_voltage = voltage() + noise_.gaussian(0.03);
  return sensors;
}

} // namespace water_sampler
