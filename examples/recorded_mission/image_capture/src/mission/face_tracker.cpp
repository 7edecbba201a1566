#include "image_capture/face_tracker.h"

#include <cmath>

namespace image_capture {

FaceTracker::FaceTracker(ros::NodeHandle &private_nh) {
  private_nh.param("face_detection_threshold", face_detection_threshold_, 25);
  private_nh.param("association_gate", association_gate_, 0.35);
  private_nh.param("lost_face_timeout", lost_face_timeout_, 0.8);
  private_nh.param("min_track_coverage", min_track_coverage_, 0.006);
}

const Face *FaceTracker::select(const FaceArray &image) const {
  const Face *best = nullptr;
  double best_rating = 0.0;
  for (const Face &face : image.faces) {
    if (face.coverage < min_track_coverage_)
      continue;
    const double jump = std::fabs(face.offset_x - offset_x_);
    if (sightings_ > 0 && jump > association_gate_)
      continue;
    const double rating = sightings_ > 0 ? -jump : face.score;
    if (!best || rating > best_rating) {
      best = &face;
      best_rating = rating;
    }
  }
  return best;
}

bool FaceTracker::update(const FaceArray &image, const ros::Time &now) {
  const Face *face = select(image);
  if (!face) {
    if (sightings_ > 0)
      --sightings_;
    return false;
  }
  if (sightings_ == 0)
    coverage_filter_.reset();
  ++sightings_;
  last_seen_ = now;
  offset_x_ = face->offset_x;
  coverage_filter_.update(face->coverage);
  return true;
}

bool FaceTracker::identified() const {
  return sightings_ >= face_detection_threshold_;
}

bool FaceTracker::lost(const ros::Time &now) const {
  return sightings_ == 0 || (now - last_seen_).toSec() > lost_face_timeout_;
}

void FaceTracker::reset() {
  sightings_ = 0;
  offset_x_ = 0.0;
  coverage_filter_.reset();
}

} // namespace image_capture
