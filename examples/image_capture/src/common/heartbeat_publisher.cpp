#include "image_capture/heartbeat_publisher.h"

#include <image_capture/Heartbeat.h>

namespace image_capture {

HeartbeatPublisher::HeartbeatPublisher(ros::NodeHandle &nh,
                                       ros::NodeHandle &private_nh) {
  private_nh.param("heartbeat_period", heartbeat_period_, 0.5);
  heartbeat_pub_ = nh.advertise<Heartbeat>("/heartbeat", 10);
  timer_ = nh.createTimer(ros::Duration(heartbeat_period_),
                          &HeartbeatPublisher::onTimer, this);
}

void HeartbeatPublisher::onTimer(const ros::TimerEvent &event) {
  Heartbeat message;
  message.header.stamp = event.current_real;
  message.node = ros::this_node::getName();
  message.count = count_++;
  heartbeat_pub_.publish(message);
}

} // namespace image_capture
