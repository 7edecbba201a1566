#include "water_sampler/uav_dynamics.h"

#include <cmath>

namespace water_sampler {

namespace {
constexpr double Gravity = 9.81;
constexpr double HoverThrust = 0.5;
constexpr double AttitudeLag = 0.12;
constexpr double MotorLag = 0.05;
constexpr double Drag = 0.3;
constexpr double FullVoltage = 12.5;
constexpr double EmptyVoltage = 10.2;

double lag(double value, double target, double interval, double constant) {
  return value + (target - value) * (1.0 - std::exp(-interval / constant));
}
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
  const double thrust = powered ? command.thrust : 0.0;
  state_.thrust = lag(state_.thrust, thrust, interval, MotorLag);
  state_.charge -= state_.thrust * interval / battery_seconds_;
  gust_x_.step(noise_, interval);
  gust_y_.step(noise_, interval);
  baro_drift_.step(noise_, interval);
  if (state_.z > 0.0 || state_.vz > 0.0) {
    state_.roll = lag(state_.roll, command.roll, interval, AttitudeLag);
    state_.pitch = lag(state_.pitch, command.pitch, interval, AttitudeLag);
    moveSideways(interval);
  }
  moveUp(interval);
}

void UavDynamics::moveSideways(double interval) {
  // A positive pitch speeds up along x, a positive roll along y.
  double ax = Gravity * std::tan(state_.pitch) - Drag * state_.vx;
  double ay = Gravity * std::tan(state_.roll) - Drag * state_.vy;
  if (enable_wind_) {
    ax += wind_x_ + gust_x_.value();
    ay += wind_y_ + gust_y_.value();
  }
  state_.vx += ax * interval;
  state_.vy += ay * interval;
  state_.x += state_.vx * interval;
  state_.y += state_.vy * interval;
}

void UavDynamics::moveUp(double interval) {
  const double lift = state_.thrust / HoverThrust * Gravity *
                      std::cos(state_.roll) * std::cos(state_.pitch);
  state_.vz += (lift - Gravity - Drag * state_.vz) * interval;
  state_.z += state_.vz * interval;
  if (state_.z <= 0.0 && state_.vz <= 0.0) {
    state_.z = 0.0;
    state_.vx = state_.vy = state_.vz = 0.0;
    state_.roll = state_.pitch = 0.0;
  }
}

double UavDynamics::voltage() const {
  const double sag = 0.4 * state_.thrust;
  return EmptyVoltage + (FullVoltage - EmptyVoltage) * state_.charge - sag;
}

UavSensors UavDynamics::sense(const ros::Time &stamp, double surface) {
  battery_empty_ = voltage() < battery_empty_voltage_;
  UavSensors sensors;
  sensors.header.stamp = stamp;
  sensors.gps_x = state_.x + noise_.gaussian(0.008);
  sensors.gps_y = state_.y + noise_.gaussian(0.008);
  sensors.gps_valid = !noise_.chance(gps_dropout_);
  sensors.baro_z = state_.z + baro_drift_.value() + noise_.gaussian(0.02);
  const double slant = std::cos(state_.roll) * std::cos(state_.pitch);
  sensors.sonar_range = (state_.z - surface) / slant + noise_.gaussian(0.01);
  sensors.roll = state_.roll + noise_.gaussian(0.003);
  sensors.pitch = state_.pitch + noise_.gaussian(0.003);
  sensors.battery_voltage = voltage() + noise_.gaussian(0.03);
  return sensors;
}

} // namespace water_sampler
