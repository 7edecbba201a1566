#include "water_sampler/probe.h"

namespace water_sampler {

Probe::Probe(ros::NodeHandle &private_nh) {
  private_nh.param("min_conductivity", min_conductivity_, 250.0);
  private_nh.param("short_conductivity", short_conductivity_, 2000.0);
}

void Probe::update(double conductivity) {
  // No water conducts like this: the contacts touch, and the reading is void.
  if (conductivity > short_conductivity_) {
    ++shorts_;
    return;
  }
  conductivity_ = conductivity;
  wet_readings_ = conductivity > min_conductivity_ ? wet_readings_ + 1 : 0;
}

} // namespace water_sampler
