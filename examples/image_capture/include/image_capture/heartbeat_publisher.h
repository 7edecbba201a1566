// Tells the base station that a node is alive.
#ifndef IMAGE_CAPTURE_HEARTBEAT_PUBLISHER_H
#define IMAGE_CAPTURE_HEARTBEAT_PUBLISHER_H

#include <cstdint>

#include <ros/ros.h>

namespace image_capture {

class HeartbeatPublisher {
public:
  /// Reads `heartbeat_period` (s) below `private_nh`, advertises /heartbeat.
  HeartbeatPublisher(ros::NodeHandle &nh, ros::NodeHandle &private_nh);

private:
  void onTimer(const ros::TimerEvent &event);

  ros::Publisher heartbeat_pub_;
  ros::Timer timer_;
  double heartbeat_period_;
  std::uint32_t count_ = 0;
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_HEARTBEAT_PUBLISHER_H
