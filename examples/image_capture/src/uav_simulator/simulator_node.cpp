#include "image_capture/simulator_node.h"

#include <geometry_msgs/PoseStamped.h>
#include <simulated_world/truth.h>

namespace image_capture {

using simulated_world::poseAt;

namespace {
constexpr std::size_t PictureBytes = 20000;
constexpr std::size_t PreviewBytes = 400;
constexpr double PreviewPeriod = 2.0;
constexpr double TruthPeriod = 0.1;
} // namespace

SimulatorNode::SimulatorNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh,
                             std::uint32_t seed)
    : clock_(nh), dynamics_(private_nh, seed),
      camera_(private_nh, seed + 1000u), pixels_(seed + 2000u) {
  private_nh.param("rate", rate_, 4.0);
  private_nh.param("sensor_period", sensor_period_, 0.06);
  private_nh.param("image_period", image_period_, 0.1);
  private_nh.param("max_command_lag", max_command_lag_, 0.0);
  private_nh.param("max_tick_lag", max_tick_lag_, 0.09);
  private_nh.param("shutter_interval", shutter_interval_, 0.5);
  sensors_pub_ = nh.advertise<UavSensors>("/uav/sensors", 10);
  observation_pub_ = nh.advertise<Observation>("/camera/observation", 10);
  picture_pub_ = nh.advertise<Picture>("/camera/picture", 4);
  preview_pub_ = nh.advertise<Picture>("/camera/preview", 4);
  uav_truth_pub_ = nh.advertise<geometry_msgs::PoseStamped>("/truth/uav", 100);
  person_truth_pub_ =
      nh.advertise<geometry_msgs::PoseStamped>("/truth/person", 100);
  command_sub_ = nh.subscribe("/uav/command", 10, &SimulatorNode::onCommand,
                              this, ros::TransportHints().tcpNoDelay());
  faces_sub_ = nh.subscribe("/camera/faces", 10, &SimulatorNode::onFaces, this,
                            ros::TransportHints().tcpNoDelay());
  waypose_sub_ = nh.subscribe("/mission/waypose", 10, &SimulatorNode::onWayPose,
                              this, ros::TransportHints().tcpNoDelay());
  capture_server_ =
      nh.advertiseService("/camera/capture", &SimulatorNode::onCapture, this);
}

void SimulatorNode::run(ros::NodeHandle &private_nh) {
  double max_duration = 600.0;
  private_nh.getParam("max_duration", max_duration);
  waitForPilot();
  while (ros::ok()) {
    ros::spinOnce();
    if (clock_.every(1.0) && clock_.now() > max_duration)
      break;
    tick();
    controller_.hold(max_command_lag_);
    detector_.hold(max_command_lag_);
    mission_.hold(max_tick_lag_);
    clock_.keepPace(rate_);
  }
}

void SimulatorNode::waitForPilot() {
  // The time begins when all nodes that decide are there.
  while (ros::ok() && (sensors_pub_.getNumSubscribers() == 0 ||
                       observation_pub_.getNumSubscribers() == 0 ||
                       command_sub_.getNumPublishers() == 0 ||
                       faces_sub_.getNumPublishers() == 0 ||
                       waypose_sub_.getNumPublishers() == 0)) {
    ros::WallDuration(0.02).sleep();
    ros::spinOnce();
  }
  // And a moment later, in which they connect to each other.
  ros::WallDuration(0.5).sleep();
}

void SimulatorNode::tick() {
  clock_.advance();
  const ros::Time stamp = clock_.stamp();
  dynamics_.step(command_, clock_.Step);
  // The mission acts ten times a second by the clock. With a smaller lag than
  // that, the time stands still until it has acted.
  mission_.sent(stamp);
  if (clock_.every(sensor_period_)) {
    controller_.sent(stamp);
    sensors_pub_.publish(dynamics_.sense(stamp));
  }
  if (clock_.every(image_period_)) {
    detector_.sent(stamp);
    Observation image = camera_.observe(dynamics_.state(), clock_.now());
    image.header.stamp = stamp;
    observation_pub_.publish(image);
  }
  if (clock_.every(TruthPeriod))
    publishTruth();
  if (clock_.every(PreviewPeriod))
    preview_pub_.publish(makePicture(PreviewBytes));
}

void SimulatorNode::onCommand(const AttitudeCommand &command) {
  command_ = command;
  controller_.answered(command.header.stamp);
}

void SimulatorNode::onFaces(const FaceArray &faces) {
  detector_.answered(faces.header.stamp);
}

void SimulatorNode::onWayPose(const WayPose &waypose) {
  mission_.answered(waypose.header.stamp);
}

bool SimulatorNode::onCapture(CapturePicture::Request &request,
                              CapturePicture::Response &response) {
  if (clock_.now() - last_shutter_ < shutter_interval_) {
    response.accepted = false;
    return true;
  }
  last_shutter_ = clock_.now();
  ++pictures_;
  picture_pub_.publish(makePicture(PictureBytes));
  ROS_INFO("picture %u, the face covers %.3f", pictures_, request.coverage);
  response.accepted = true;
  response.picture_id = pictures_;
  return true;
}

Picture SimulatorNode::makePicture(std::size_t bytes) {
  Picture picture;
  picture.header.stamp = clock_.stamp();
  picture.id = pictures_;
  picture.data.resize(bytes);
  for (std::uint8_t &pixel : picture.data)
    pixel = static_cast<std::uint8_t>(pixels_.uniform(0.0, 256.0));
  return picture;
}

void SimulatorNode::publishTruth() {
  const ros::Time stamp = clock_.stamp();
  const UavState &uav = dynamics_.state();
  uav_truth_pub_.publish(poseAt(stamp, uav.x, uav.y, uav.z, uav.yaw));
  const Person head = camera_.person(clock_.now());
  person_truth_pub_.publish(poseAt(stamp, head.x, head.y, 1.6, 0.0));
}

} // namespace image_capture
