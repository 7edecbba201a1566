#include "image_capture/simulator_node.h"

#include <cmath>

#include <geometry_msgs/PoseStamped.h>
#include <rosgraph_msgs/Clock.h>

namespace image_capture {

namespace {
constexpr std::size_t PictureBytes = 20000;
constexpr std::size_t PreviewBytes = 400;
constexpr double PreviewPeriod = 2.0;
constexpr double TruthPeriod = 0.1;
/// A controller that is gone must not stop the time for good.
constexpr double LongestHold = 0.5;

geometry_msgs::PoseStamped poseAt(const ros::Time &stamp, double x, double y,
                                  double z, double yaw) {
  geometry_msgs::PoseStamped pose;
  pose.header.stamp = stamp;
  pose.header.frame_id = "map";
  pose.pose.position.x = x;
  pose.pose.position.y = y;
  pose.pose.position.z = z;
  pose.pose.orientation.z = std::sin(0.5 * yaw);
  pose.pose.orientation.w = std::cos(0.5 * yaw);
  return pose;
}
} // namespace

SimulatorNode::SimulatorNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh,
                             std::uint32_t seed)
    : dynamics_(private_nh, seed), camera_(private_nh, seed + 1000u),
      pixels_(seed + 2000u) {
  private_nh.param("rate", rate_, 4.0);
  private_nh.param("sensor_period", sensor_period_, 0.06);
  private_nh.param("image_period", image_period_, 0.1);
  private_nh.param("max_command_lag", max_command_lag_, 0.12);
  private_nh.param("shutter_interval", shutter_interval_, 0.5);
  clock_pub_ = nh.advertise<rosgraph_msgs::Clock>("/clock", 50);
  sensors_pub_ = nh.advertise<UavSensors>("/uav/sensors", 10);
  observation_pub_ = nh.advertise<Observation>("/camera/observation", 10);
  picture_pub_ = nh.advertise<Picture>("/camera/picture", 4);
  preview_pub_ = nh.advertise<Picture>("/camera/preview", 4);
  uav_truth_pub_ = nh.advertise<geometry_msgs::PoseStamped>("/truth/uav", 20);
  person_truth_pub_ =
      nh.advertise<geometry_msgs::PoseStamped>("/truth/person", 20);
  command_sub_ = nh.subscribe("/uav/command", 10, &SimulatorNode::onCommand,
                              this, ros::TransportHints().tcpNoDelay());
  capture_server_ =
      nh.advertiseService("/camera/capture", &SimulatorNode::onCapture, this);
}

void SimulatorNode::run(ros::NodeHandle &private_nh) {
  double max_duration = 600.0;
  private_nh.getParam("max_duration", max_duration);
  // The time begins when the UAV has a pilot.
  while (ros::ok() && sensors_pub_.getNumSubscribers() == 0) {
    ros::WallDuration(0.02).sleep();
    ros::spinOnce();
  }
  ros::WallTime next = ros::WallTime::now();
  while (ros::ok()) {
    ros::spinOnce();
    if (every(1.0) && now() > max_duration)
      break;
    tick();
    waitForController();
    next += ros::WallDuration(Step / rate_);
    const ros::WallTime now = ros::WallTime::now();
    if (next > now)
      (next - now).sleep();
    else if ((now - next).toSec() > 0.05)
      next = now; // too slow to keep up: lose time, do not rush
  }
}

void SimulatorNode::tick() {
  ++ticks_;
  dynamics_.step(command_, Step);
  publishClock();
  if (every(sensor_period_)) {
    sensor_ticks_ = ticks_;
    sensors_pub_.publish(dynamics_.sense(stamp()));
  }
  if (every(image_period_)) {
    Observation image = camera_.observe(dynamics_.state(), now());
    image.header.stamp = stamp();
    observation_pub_.publish(image);
  }
  if (every(TruthPeriod))
    publishTruth();
  if (every(PreviewPeriod))
    preview_pub_.publish(makePicture(PreviewBytes));
}

void SimulatorNode::waitForController() {
  if (command_ticks_ < 0 || sensor_ticks_ != ticks_)
    return;
  // On a busy machine the time waits for the controller, so that the flight
  // does not depend on the load.
  double held = 0.0;
  while (ros::ok() && commandLag() > max_command_lag_ && held < LongestHold) {
    ros::WallDuration(0.001).sleep();
    held += 0.001;
    ros::spinOnce();
  }
}

double SimulatorNode::commandLag() const {
  return static_cast<double>(sensor_ticks_ - command_ticks_) * Step;
}

void SimulatorNode::onCommand(const AttitudeCommand &command) {
  command_ = command;
  command_ticks_ = static_cast<std::int64_t>(
      std::llround(command.header.stamp.toSec() / Step));
}

bool SimulatorNode::onCapture(CapturePicture::Request &request,
                              CapturePicture::Response &response) {
  if (now() - last_shutter_ < shutter_interval_) {
    response.accepted = false;
    return true;
  }
  last_shutter_ = now();
  ++pictures_;
  picture_pub_.publish(makePicture(PictureBytes));
  ROS_INFO("picture %u, the face covers %.3f", pictures_, request.coverage);
  response.accepted = true;
  response.picture_id = pictures_;
  return true;
}

Picture SimulatorNode::makePicture(std::size_t bytes) {
  Picture picture;
  picture.header.stamp = stamp();
  picture.id = pictures_;
  picture.data.resize(bytes);
  for (std::uint8_t &pixel : picture.data)
    pixel = static_cast<std::uint8_t>(pixels_.uniform(0.0, 256.0));
  return picture;
}

void SimulatorNode::publishClock() {
  rosgraph_msgs::Clock clock;
  clock.clock = stamp();
  clock_pub_.publish(clock);
}

void SimulatorNode::publishTruth() {
  const UavState &uav = dynamics_.state();
  uav_truth_pub_.publish(poseAt(stamp(), uav.x, uav.y, uav.z, uav.yaw));
  const Person head = camera_.person(now());
  person_truth_pub_.publish(poseAt(stamp(), head.x, head.y, 1.6, 0.0));
}

ros::Time SimulatorNode::stamp() const {
  const std::int64_t milliseconds = ticks_ * 10;
  return ros::Time(static_cast<std::uint32_t>(milliseconds / 1000),
                   static_cast<std::uint32_t>(milliseconds % 1000) * 1000000u);
}

bool SimulatorNode::every(double seconds) const {
  return ticks_ % std::llround(seconds / Step) == 0;
}

} // namespace image_capture
