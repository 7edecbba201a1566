// The flight controller: sensors and way poses in, attitude commands out.
#ifndef WATER_SAMPLER_CONTROLLER_NODE_H
#define WATER_SAMPLER_CONTROLLER_NODE_H

#include <ros/ros.h>
#include <water_sampler/UavSensors.h>
#include <water_sampler/WayPose.h>

#include "water_sampler/axis_controllers.h"
#include "water_sampler/safety_monitor.h"
#include "water_sampler/state_estimator.h"

namespace water_sampler {

class ControllerNode {
public:
  ControllerNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh);

private:
  void onSensors(const UavSensors &sensors);
  void onWayPose(const WayPose &waypose);
  void onHousekeeping(const ros::TimerEvent &event);
  void publishCommand(const ros::Time &stamp);
  void publishState(const ros::Time &stamp);

  StateEstimator estimator_;
  PositionController position_controller_;
  HeightController height_controller_;
  SafetyMonitor safety_;

  ros::Publisher command_pub_;
  ros::Publisher state_pub_;
  ros::Subscriber sensors_sub_;
  ros::Subscriber waypose_sub_;
  ros::Timer housekeeping_timer_;

  Target target_;
  ros::Time last_waypose_;
  double waypose_idle_timeout_;
  double battery_voltage_ = 0.0;
  bool waypose_fresh_ = false;
  bool motors_on_ = false;
  bool aborting_ = false;
};

} // namespace water_sampler

#endif // WATER_SAMPLER_CONTROLLER_NODE_H
