// Follows one face from image to image.
#ifndef IMAGE_CAPTURE_FACE_TRACKER_H
#define IMAGE_CAPTURE_FACE_TRACKER_H

#include <image_capture/Face.h>
#include <image_capture/FaceArray.h>
#include <ros/ros.h>

#include "image_capture/filters.h"

namespace image_capture {

class FaceTracker {
public:
  explicit FaceTracker(ros::NodeHandle &private_nh);

  /// True if the image shows the tracked face. If none is tracked, the best
  /// face of the image becomes the tracked one.
  bool update(const FaceArray &image, const ros::Time &now);

  /// Seen in so many images that it counts as a person.
  bool identified() const;
  /// Not seen for too long.
  bool lost(const ros::Time &now) const;
  void reset();

  int sightings() const { return sightings_; }
  double coverage() const { return coverage_filter_.value(); }
  double offsetX() const { return offset_x_; }

private:
  const Face *select(const FaceArray &image) const;

  int face_detection_threshold_;
  double association_gate_;
  double lost_face_timeout_;
  double min_track_coverage_;

  int sightings_ = 0;
  double offset_x_ = 0.0;
  IirLowPass coverage_filter_{0.3};
  ros::Time last_seen_;
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_FACE_TRACKER_H
