// Owns the simulated time: moves the UAV and the water, publishes /clock, the
// sensors, and the truth that an observer sees.
#ifndef WATER_SAMPLER_SIMULATOR_NODE_H
#define WATER_SAMPLER_SIMULATOR_NODE_H

#include <cstdint>

#include <ros/ros.h>
#include <simulated_world/simulated_clock.h>
#include <water_sampler/WayPose.h>

#include "water_sampler/uav_dynamics.h"
#include "water_sampler/water_model.h"

namespace water_sampler {

class SimulatorNode {
public:
  SimulatorNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh,
                std::uint32_t seed);

  /// Until ROS shuts down, or `max_duration` (s, simulated) is over.
  void run(ros::NodeHandle &private_nh);

private:
  void onCommand(const AttitudeCommand &command);
  void onDrive(const PumpDrive &drive);
  void onWayPose(const WayPose &waypose);
  void waitForPilot();
  void tick();
  void publishTruth();

  simulated_world::SimulatedClock clock_;
  simulated_world::Lockstep controller_, mission_, pump_;
  UavDynamics dynamics_;
  WaterModel water_;
  ros::Publisher sensors_pub_, sampler_pub_;
  ros::Publisher uav_truth_pub_, sampler_truth_pub_, filled_pub_;
  ros::Subscriber command_sub_, drive_sub_, waypose_sub_;

  AttitudeCommand command_;
  PumpDrive drive_;
  double rate_;
  double sensor_period_;
  double sampler_period_;
  double max_command_lag_;
  bool filled_ = false;
};

} // namespace water_sampler

#endif // WATER_SAMPLER_SIMULATOR_NODE_H
