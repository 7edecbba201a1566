// The face detector: observations of the camera in, faces out.
#ifndef IMAGE_CAPTURE_DETECTOR_NODE_H
#define IMAGE_CAPTURE_DETECTOR_NODE_H

#include <image_capture/FaceArray.h>
#include <image_capture/Observation.h>
#include <ros/ros.h>
#include <std_msgs/Bool.h>

#include "image_capture/blob_filter.h"
#include "image_capture/heartbeat_publisher.h"

namespace image_capture {

class DetectorNode {
public:
  DetectorNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh);

private:
  void onEnable(const std_msgs::Bool &enable) { enabled_ = enable.data; }
  void onObservation(const Observation &observation);
  void findFaces(const Observation &observation, FaceArray &result);
  bool sharp(const Observation &observation) const;

  BlobFilter filter_;
  HeartbeatPublisher heartbeat_;
  ros::Publisher faces_pub_;
  ros::Subscriber enable_sub_;
  ros::Subscriber observation_sub_;
  bool enabled_ = true;
  double max_motion_blur_;
  int max_faces_;
  bool detect_when_blurred_;
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_DETECTOR_NODE_H
