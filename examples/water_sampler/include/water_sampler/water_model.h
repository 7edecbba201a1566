// The tank, the tube that hangs from the UAV, the pump and the vial.
#ifndef WATER_SAMPLER_WATER_MODEL_H
#define WATER_SAMPLER_WATER_MODEL_H

#include <cstdint>

#include <ros/ros.h>
#include <simulated_world/noise.h>
#include <water_sampler/PumpDrive.h>
#include <water_sampler/SamplerSensors.h>
#include <water_sampler/SamplerTruth.h>

#include "water_sampler/uav_dynamics.h"

namespace water_sampler {

class WaterModel {
public:
  explicit WaterModel(std::uint32_t seed);

  void step(const UavState &uav, const PumpDrive &drive, double interval);
  SamplerSensors sense(const ros::Time &stamp);
  SamplerTruth truth(const ros::Time &stamp) const;
  /// The height of the surface that the sonar hits below a place, m.
  double surfaceBelow(double x, double y) const;
  bool vialFilled() const;

private:
  bool aboveTank() const;
  void sway(const UavState &uav, double interval);
  void spray(double interval);
  void pump(const PumpDrive &drive, double interval);

  simulated_world::Noise noise_;
  double tip_x_ = 0.0, tip_y_ = 0.0, tip_z_ = 0.0;
  double spray_left_ = 0.0;  ///< of the burst that wets the tip, s
  double spray_pause_left_;  ///< until the next burst, s
  double spray_level_ = 0.0; ///< its conductivity
  double flow_ = 0.0;        ///< ml/s
  double current_ = 0.0;     ///< A
  double vial_ = 0.0;        ///< ml
  bool in_water_ = false;
  bool pump_running_ = false;
};

} // namespace water_sampler

#endif // WATER_SAMPLER_WATER_MODEL_H
