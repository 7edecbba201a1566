// Owns the simulated time: moves the UAV, publishes /clock, the sensors, the
// observations of the camera and the truth that an observer sees.
#ifndef IMAGE_CAPTURE_SIMULATOR_NODE_H
#define IMAGE_CAPTURE_SIMULATOR_NODE_H

#include <cstdint>

#include <image_capture/AttitudeCommand.h>
#include <image_capture/CapturePicture.h>
#include <image_capture/FaceArray.h>
#include <image_capture/Picture.h>
#include <image_capture/WayPose.h>
#include <ros/ros.h>
#include <simulated_world/noise.h>
#include <simulated_world/simulated_clock.h>

#include "image_capture/camera_model.h"
#include "image_capture/uav_dynamics.h"

namespace image_capture {

class SimulatorNode {
public:
  SimulatorNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh,
                std::uint32_t seed);

  /// Until ROS shuts down, or `max_duration` (s, simulated) is over.
  void run(ros::NodeHandle &private_nh);

private:
  void onCommand(const AttitudeCommand &command);
  void onFaces(const FaceArray &faces);
  void onWayPose(const WayPose &waypose);
  bool onCapture(CapturePicture::Request &request,
                 CapturePicture::Response &response);
  void tick();
  void waitForPilot();
  void publishTruth();
  Picture makePicture(std::size_t bytes);

  simulated_world::SimulatedClock clock_;
  simulated_world::Lockstep controller_, detector_, mission_;
  UavDynamics dynamics_;
  CameraModel camera_;
  simulated_world::Noise pixels_;
  ros::Publisher sensors_pub_, observation_pub_;
  ros::Publisher picture_pub_, preview_pub_;
  ros::Publisher uav_truth_pub_, person_truth_pub_;
  ros::Subscriber command_sub_, faces_sub_, waypose_sub_;
  ros::ServiceServer capture_server_;

  AttitudeCommand command_;
  double rate_;
  double sensor_period_;
  double image_period_;
  double max_command_lag_;
  double max_tick_lag_;
  double shutter_interval_;
  double last_shutter_ = -1.0e3;
  std::uint32_t pictures_ = 0;
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_SIMULATOR_NODE_H
