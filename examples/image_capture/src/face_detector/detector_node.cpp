#include "image_capture/detector_node.h"

#include <cmath>

namespace image_capture {

DetectorNode::DetectorNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh)
    : filter_(private_nh), heartbeat_(nh, private_nh) {
  private_nh.param("max_motion_blur", max_motion_blur_, 0.05);
  private_nh.param("max_faces", max_faces_, 6);
  private_nh.param("detect_when_blurred", detect_when_blurred_, false);
  faces_pub_ = nh.advertise<FaceArray>("/camera/faces", 10);
  enable_sub_ =
      nh.subscribe("/camera/detect", 4, &DetectorNode::onEnable, this);
  observation_sub_ = nh.subscribe("/camera/observation", 10,
                                  &DetectorNode::onObservation, this);
}

void DetectorNode::onObservation(const Observation &observation) {
  FaceArray result;
  result.header.stamp = observation.header.stamp;
  result.image_id = observation.image_id;
  result.frame_rate = observation.frame_rate;
  if (enabled_ && (sharp(observation) || detect_when_blurred_))
    findFaces(observation, result);
  faces_pub_.publish(result);
  ROS_DEBUG("%u strong responses so far", filter_.strongResponses());
}

void DetectorNode::findFaces(const Observation &observation,
                             FaceArray &result) {
  const double area = static_cast<double>(observation.image_width) *
                      static_cast<double>(observation.image_height);
  for (const Blob &blob : observation.blobs) {
    if (static_cast<int>(result.faces.size()) >= max_faces_)
      break;
    Face face;
    if (!filter_.accepts(blob, face.score))
      continue;
    face.offset_x = blob.offset_x;
    face.offset_y = blob.offset_y;
    face.coverage = blob.width * blob.height / area;
    result.faces.push_back(face);
  }
}

bool DetectorNode::sharp(const Observation &observation) const {
  const double blur =
      std::fabs(observation.yaw_rate) * observation.exposure_time;
  return blur < max_motion_blur_;
}

} // namespace image_capture
