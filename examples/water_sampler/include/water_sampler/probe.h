// Distinguishes water from air at the tip of the tube.
#ifndef WATER_SAMPLER_PROBE_H
#define WATER_SAMPLER_PROBE_H

#include <ros/ros.h>

namespace water_sampler {

class Probe {
public:
  explicit Probe(ros::NodeHandle &private_nh);

  /// Takes a reading in microsiemens per cm.
  void update(double conductivity);
  /// How many readings in a row were in water.
  unsigned wetReadings() const { return wet_readings_; }
  double conductivity() const { return conductivity_; }
  unsigned shorts() const { return shorts_; }

private:
  double min_conductivity_;
  double short_conductivity_;
  double conductivity_ = 0.0;
  unsigned wet_readings_ = 0;
  unsigned shorts_ = 0;
};

} // namespace water_sampler

#endif // WATER_SAMPLER_PROBE_H
