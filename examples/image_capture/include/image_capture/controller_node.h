// The flight controller: sensors and way poses in, attitude commands out.
#ifndef IMAGE_CAPTURE_CONTROLLER_NODE_H
#define IMAGE_CAPTURE_CONTROLLER_NODE_H

#include <cstdint>

#include <image_capture/FlightState.h>
#include <image_capture/UavSensors.h>
#include <image_capture/WayPose.h>
#include <ros/ros.h>

#include "image_capture/axis_controllers.h"
#include "image_capture/heartbeat_publisher.h"
#include "image_capture/safety_monitor.h"
#include "image_capture/state_estimator.h"

namespace image_capture {

class ControllerNode {
public:
  ControllerNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh);

private:
  void onSensors(const UavSensors &sensors);
  void onWayPose(const WayPose &waypose);
  void onHousekeeping(const ros::TimerEvent &event);

  void checkSafety(const ros::Time &now);
  void updateMode();
  void publishCommand(const ros::Time &stamp);
  void publishState(const ros::Time &stamp);

  StateEstimator estimator_;
  PositionController position_controller_;
  HeightController height_controller_;
  YawController yaw_controller_;
  SafetyMonitor safety_;
  HeartbeatPublisher heartbeat_;

  ros::Publisher command_pub_;
  ros::Publisher state_pub_;
  ros::Subscriber sensors_sub_;
  ros::Subscriber waypose_sub_;
  ros::Timer housekeeping_timer_;

  Target target_;
  ros::Time last_waypose_;
  double waypose_idle_timeout_;
  double battery_voltage_ = 0.0;
  std::uint8_t mode_ = FlightState::MODE_ATTITUDE;
  bool waypose_fresh_ = false;
  bool motors_on_ = false;
  bool aborting_ = false;
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_CONTROLLER_NODE_H
