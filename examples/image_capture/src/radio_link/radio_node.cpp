#include "image_capture/radio_node.h"

#include <cmath>

namespace image_capture {

namespace {

/// A preview older than this, in s, is out of date.
double stale_preview_age = 1.0;

/// The message as it would go over the air.
template <typename Message>
std::vector<std::uint8_t> serialize(const Message &message) {
  std::vector<std::uint8_t> bytes(
      ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(),
                                     static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

} // namespace

RadioNode::RadioNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh)
    : packetizer_(private_nh), heartbeat_(nh, private_nh) {
  private_nh.param("min_displacement", min_displacement_, 0.05);
  private_nh.param("min_z_displacement", min_z_displacement_, 0.15);
  private_nh.param("enable_preview", enable_preview_, true);
  private_nh.param("stale_preview_age", stale_preview_age, 1.0);
  private_nh.param("enable_link", enable_link_, true);
  packet_pub_ = nh.advertise<Packet>("/radio/packets", 50);
  flight_sub_ =
      nh.subscribe("/controller/state", 10, &RadioNode::onFlightState, this);
  mission_sub_ =
      nh.subscribe("/mission/state", 10, &RadioNode::onMissionState, this);
  heartbeat_sub_ =
      nh.subscribe("/heartbeat", 20, &RadioNode::onHeartbeat, this);
  picture_sub_ =
      nh.subscribe("/camera/picture", 2, &RadioNode::onPicture, this);
  preview_sub_ =
      nh.subscribe("/camera/preview", 2, &RadioNode::onPreview, this);
  pose_timer_ =
      nh.createTimer(ros::Duration(0.2), &RadioNode::onPoseTimer, this);
  transmit_timer_ =
      nh.createTimer(ros::Duration(0.02), &RadioNode::onTransmitTimer, this);
}

void RadioNode::onMissionState(const MissionState &state) {
  packetizer_.push(Packet::MISSION, serialize(state), state.header.stamp);
}

void RadioNode::onHeartbeat(const Heartbeat &heartbeat) {
  packetizer_.push(Packet::MISSION, serialize(heartbeat),
                   heartbeat.header.stamp);
}

void RadioNode::onPicture(const Picture &picture) {
  packetizer_.push(Packet::PICTURE, picture.data, picture.header.stamp);
}

void RadioNode::onPreview(const Picture &picture) {
  if (!enable_preview_)
    return;
  if ((ros::Time::now() - picture.header.stamp).toSec() > stale_preview_age)
    return;
  packetizer_.push(Packet::PREVIEW, picture.data, picture.header.stamp);
}

bool RadioNode::hasMoved() const {
  const double dx = flight_.position.x - sent_.position.x;
  const double dy = flight_.position.y - sent_.position.y;
  const double dz = flight_.position.z - sent_.position.z;
  if (std::hypot(dx, dy) > min_displacement_)
    return true;
  return std::fabs(dz) > min_z_displacement_;
}

void RadioNode::onPoseTimer(const ros::TimerEvent &event) {
  if (!hasMoved())
    return;
  sent_ = flight_;
  sent_.header.stamp = event.current_real;
  packetizer_.push(Packet::POSE, serialize(sent_), event.current_real);
}

void RadioNode::onTransmitTimer(const ros::TimerEvent &) {
  if (packetizer_.empty() || !enable_link_)
    return;
  packet_pub_.publish(packetizer_.pop());
}

} // namespace image_capture
