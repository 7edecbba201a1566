// The radio link to the base station.
#ifndef IMAGE_CAPTURE_RADIO_NODE_H
#define IMAGE_CAPTURE_RADIO_NODE_H

#include <image_capture/FlightState.h>
#include <image_capture/Heartbeat.h>
#include <image_capture/MissionState.h>
#include <image_capture/Picture.h>
#include <ros/ros.h>

#include "image_capture/heartbeat_publisher.h"
#include "image_capture/packetizer.h"

namespace image_capture {

class RadioNode {
public:
  RadioNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh);

private:
  void onFlightState(const FlightState &state) { flight_ = state; }
  void onMissionState(const MissionState &state);
  void onHeartbeat(const Heartbeat &heartbeat);
  void onPicture(const Picture &picture);
  void onPreview(const Picture &picture);
  void onPoseTimer(const ros::TimerEvent &event);
  void onTransmitTimer(const ros::TimerEvent &event);
  bool hasMoved() const;

  Packetizer packetizer_;
  HeartbeatPublisher heartbeat_;
  ros::Publisher packet_pub_;
  ros::Subscriber flight_sub_, mission_sub_, heartbeat_sub_;
  ros::Subscriber picture_sub_, preview_sub_;
  ros::Timer pose_timer_, transmit_timer_;

  FlightState flight_;
  FlightState sent_;
  double min_displacement_;
  double min_z_displacement_;
  bool enable_preview_;
  bool enable_link_;
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_RADIO_NODE_H
