#include "water_sampler/water_model.h"

#include <algorithm>
#include <cmath>

namespace water_sampler {

namespace {
// The world, m: constants, not configuration.
constexpr double TankX = 3.0;
constexpr double TankY = 2.0;
constexpr double TankRadius = 0.45;
constexpr double WaterLevel = 0.65;
constexpr double TubeLength = 1.0;
constexpr double SwayTime = 0.5; // s
constexpr double WaterConductivity = 450.0;
constexpr double SprayLowest = 0.25; // above the water
constexpr double SprayHighest = 0.7;
constexpr double SprayPause = 0.5;    // s, between bursts
constexpr double PumpRate = 4.0;      // ml/s
constexpr double VialCapacity = 45.0; // ml

constexpr double AirConductivity = 4.0;
constexpr double ConductivityNoise = 8.0;
constexpr double FlowNoise = 0.12;   // ml/s
constexpr double PumpLag = 0.3;      // s, until the water has come up the tube
constexpr double RunningDuty = 0.1;  // less does not turn the motor
constexpr double IdleCurrent = 0.02; // A
constexpr double FilledShare = 0.85;
} // namespace

WaterModel::WaterModel(std::uint32_t seed)
    : noise_(seed), spray_pause_left_(SprayPause) {}

void WaterModel::step(const UavState &uav, const PumpDrive &drive,
                      double interval) {
  sway(uav, interval);
  in_water_ = aboveTank() && tip_z_ < WaterLevel;
  spray(interval);
  pump(drive, interval);
}

void WaterModel::sway(const UavState &uav, double interval) {
  // The tip follows the UAV with a delay; on the ground the tube lies coiled.
  const double share = 1.0 - std::exp(-interval / SwayTime);
  tip_x_ += share * (uav.x - tip_x_);
  tip_y_ += share * (uav.y - tip_y_);
  tip_z_ = std::max(0.0, uav.z - TubeLength);
}

bool WaterModel::aboveTank() const {
  return std::hypot(tip_x_ - TankX, tip_y_ - TankY) < TankRadius;
}

void WaterModel::spray(double interval) {
  // The wind of the rotors throws drops at the tip when the UAV is low over
  // water; lower still, it flattens the water.
  const double above = tip_z_ - WaterLevel;
  if (!aboveTank() || above < SprayLowest || above > SprayHighest) {
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
  spray_left_ = noise_.uniform(0.3, 0.6);
  spray_pause_left_ = SprayPause * noise_.uniform(0.5, 1.5);
  spray_level_ = WaterConductivity * noise_.uniform(0.7, 0.9);
}

void WaterModel::pump(const PumpDrive &drive, double interval) {
  pump_running_ = drive.duty > RunningDuty;
  const double wanted =
      pump_running_ && in_water_ ? PumpRate * drive.duty : 0.0;
  flow_ += (wanted - flow_) * (1.0 - std::exp(-interval / PumpLag));
  vial_ += flow_ * interval;
  // What does not fit into the vial runs back into the tank.
  if (vial_ > VialCapacity)
    vial_ = VialCapacity;
  // Water is heavier to move than air.
  current_ = pump_running_ ? drive.duty * (0.4 + 0.15 * flow_) : IdleCurrent;
}

SamplerSensors WaterModel::sense(const ros::Time &stamp) {
  SamplerSensors sensors;
  sensors.header.stamp = stamp;
  double level = AirConductivity;
  if (in_water_)
    level = WaterConductivity;
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
  truth.tank.x = TankX;
  truth.tank.y = TankY;
  truth.tank.z = WaterLevel;
  truth.tank_radius = TankRadius;
  truth.pump_running = pump_running_;
  truth.vial_level = vial_ / VialCapacity;
  return truth;
}

double WaterModel::surfaceBelow(double x, double y) const {
  return std::hypot(x - TankX, y - TankY) < TankRadius ? WaterLevel : 0.0;
}

bool WaterModel::vialFilled() const {
  return vial_ > FilledShare * VialCapacity;
}

} // namespace water_sampler
