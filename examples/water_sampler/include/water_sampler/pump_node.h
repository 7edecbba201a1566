// The pump control: readings of the probe and the flow meter in, motor command
// out.
#ifndef WATER_SAMPLER_PUMP_NODE_H
#define WATER_SAMPLER_PUMP_NODE_H

#include <cstdint>
#include <string>

#include <ros/ros.h>
#include <water_sampler/RunPump.h>
#include <water_sampler/SamplerSensors.h>
#include <water_sampler/UavSensors.h>

#include "water_sampler/probe.h"
#include "water_sampler/pump.h"

namespace water_sampler {

class PumpNode {
public:
  PumpNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh);

private:
  void onSensors(const SamplerSensors &sensors);
  void onUav(const UavSensors &sensors);
  bool onRun(RunPump::Request &request, RunPump::Response &response);
  std::string reasonAgainst(std::uint8_t vial) const;
  void publishStatus(const ros::Time &stamp);
  void publishDrive(const ros::Time &stamp);

  Probe probe_;
  Pump pump_;
  ros::Publisher status_pub_;
  ros::Publisher drive_pub_;
  ros::Subscriber sensors_sub_;
  ros::Subscriber uav_sub_;
  ros::ServiceServer run_server_;
  double min_pump_voltage_;
  int vial_count_;
  double battery_voltage_ = 0.0;
  std::uint8_t vial_ = 0;
};

} // namespace water_sampler

#endif // WATER_SAMPLER_PUMP_NODE_H
