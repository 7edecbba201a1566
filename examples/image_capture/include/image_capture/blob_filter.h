// Tells faces from other regions of an image.
#ifndef IMAGE_CAPTURE_BLOB_FILTER_H
#define IMAGE_CAPTURE_BLOB_FILTER_H

#include <random>

#include <image_capture/Blob.h>
#include <ros/ros.h>

namespace image_capture {

class BlobFilter {
public:
  explicit BlobFilter(ros::NodeHandle &private_nh);

  /// True for a face; `score` becomes the classifier's answer, 0 to 1.
  bool accepts(const Blob &blob, double &score);
  unsigned strongResponses() const { return strong_responses_; }

private:
  bool plausibleShape(const Blob &blob) const;
  double classify(const Blob &blob);

  std::mt19937 generator_;
  std::normal_distribution<double> noise_;
  double min_contrast_;
  double min_face_width_;
  double min_aspect_ratio_;
  double max_aspect_ratio_;
  double min_detection_score_;
  double strong_response_;
  unsigned strong_responses_ = 0;
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_BLOB_FILTER_H
