#include "water_sampler/water_model.h"

#include <algorithm>
#include <cmath>

namespace water_sampler {

namespace {
constexpr double AirConductivity = 4.0;
constexpr double ConductivityNoise = 8.0;
constexpr double FlowNoise = 0.12;   // ml/s
constexpr double PumpLag = 0.3;      // s, until the water has come up the tube
constexpr double RunningDuty = 0.1;  // less does not turn the motor
constexpr double IdleCurrent = 0.02; // A
constexpr double FilledShare = 0.85;
} // namespace

WaterModel::WaterModel(ros::NodeHandle &private_nh, std::uint32_t seed)
    : noise_(seed) {
  private_nh.param("tank_x", tank_x_, 3.0);
  private_nh.param("tank_y", tank_y_, 2.0);
  private_nh.param("tank_radius", tank_radius_, 0.45);
  private_nh.param("water_level", water_level_, 0.65);
  private_nh.param("tube_length", tube_length_, 1.0);
  private_nh.param("tube_sway_time", tube_sway_time_, 0.5);
  private_nh.param("water_conductivity", water_conductivity_, 450.0);
  private_nh.param("spray_lowest", spray_lowest_, 0.25);
  private_nh.param("spray_highest", spray_highest_, 0.7);
  private_nh.param("spray_pause", spray_pause_, 0.5);
  private_nh.param("pump_rate", pump_rate_, 4.0);
  private_nh.param("vial_capacity", vial_capacity_, 45.0);
  spray_pause_left_ = spray_pause_;
}

void WaterModel::step(const UavState &uav, const PumpDrive &drive,
                      double interval) {
  sway(uav, interval);
  in_water_ = aboveTank() && tip_z_ < water_level_;
  spray(interval);
  pump(drive, interval);
}

void WaterModel::sway(const UavState &uav, double interval) {
  // The tip follows the UAV late; on the ground the tube lies coiled.
  const double share = 1.0 - std::exp(-interval / tube_sway_time_);
  tip_x_ += share * (uav.x - tip_x_);
  tip_y_ += share * (uav.y - tip_y_);
  tip_z_ = std::max(0.0, uav.z - tube_length_);
}

bool WaterModel::aboveTank() const {
  return std::hypot(tip_x_ - tank_x_, tip_y_ - tank_y_) < tank_radius_;
}

void WaterModel::spray(double interval) {
  // The rotors' wind throws drops at the tip when the UAV is low over water.
  const double above = tip_z_ - water_level_;
  if (!aboveTank() || above < spray_lowest_ || above > spray_highest_) {
    spray_left_ = 0.0;
    return;
  }
  if (spray_left_ > 0.0) {
    spray_left_ -= interval;
    return;
  }
  spray_pause_left_ -= interval;
  if (spray_pause_left_ > 0.0)
    return;
  spray_left_ = noise_.between(0.3, 0.6);
  spray_pause_left_ = spray_pause_ * noise_.between(0.5, 1.5);
  spray_level_ = water_conductivity_ * noise_.between(0.7, 0.9);
}

void WaterModel::pump(const PumpDrive &drive, double interval) {
  pump_running_ = drive.duty > RunningDuty;
  const double wanted =
      pump_running_ && in_water_ ? pump_rate_ * drive.duty : 0.0;
  flow_ += (wanted - flow_) * (1.0 - std::exp(-interval / PumpLag));
  vial_ += flow_ * interval;
  // What a full vial does not hold runs back into the tank.
  if (vial_ > vial_capacity_)
    vial_ = vial_capacity_;
  // Water is heavier to move than air.
  current_ = pump_running_ ? drive.duty * (0.4 + 0.15 * flow_) : IdleCurrent;
}

SamplerSensors WaterModel::sense(const ros::Time &stamp) {
  SamplerSensors sensors;
  sensors.header.stamp = stamp;
  double level = AirConductivity;
  if (in_water_)
    level = water_conductivity_;
  else if (spray_left_ > 0.0)
    level = spray_level_;
  sensors.conductivity =
      std::max(0.0, level + noise_.gaussian(ConductivityNoise));
  sensors.flow = std::max(0.0, flow_ + noise_.gaussian(FlowNoise));
  sensors.pump_current = current_ + noise_.gaussian(0.01);
  return sensors;
}

SamplerTruth WaterModel::truth(const ros::Time &stamp) const {
  SamplerTruth truth;
  truth.header.stamp = stamp;
  truth.tip.x = tip_x_;
  truth.tip.y = tip_y_;
  truth.tip.z = tip_z_;
  truth.tank.x = tank_x_;
  truth.tank.y = tank_y_;
  truth.tank.z = water_level_;
  truth.tank_radius = tank_radius_;
  truth.pump_running = pump_running_;
  truth.vial_level = vial_ / vial_capacity_;
  return truth;
}

double WaterModel::surfaceBelow(double x, double y) const {
  return std::hypot(x - tank_x_, y - tank_y_) < tank_radius_ ? water_level_
                                                             : 0.0;
}

bool WaterModel::vialFilled() const {
  return vial_ > FilledShare * vial_capacity_;
}

} // namespace water_sampler
