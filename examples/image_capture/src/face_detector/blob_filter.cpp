#include "image_capture/blob_filter.h"

#include <cstdint>

namespace image_capture {

BlobFilter::BlobFilter(ros::NodeHandle &private_nh) {
  int seed = 1;
  double deviation = 0.05;
  private_nh.getParam("seed", seed);
  private_nh.getParam("classifier_noise", deviation);
  private_nh.param("min_contrast", min_contrast_, 0.15);
  private_nh.param("min_face_width", min_face_width_, 24.0);
  private_nh.param("min_aspect_ratio", min_aspect_ratio_, 0.8);
  private_nh.param("max_aspect_ratio", max_aspect_ratio_, 1.8);
  private_nh.param("min_detection_score", min_detection_score_, 0.55);
  private_nh.param("strong_response", strong_response_, 0.9);
  generator_.seed(static_cast<std::uint32_t>(seed) + 7001u);
  noise_ = std::normal_distribution<double>(0.0, deviation);
}

bool BlobFilter::accepts(const Blob &blob, double &score) {
  if (blob.response > strong_response_)
    ++strong_responses_;
  if (blob.contrast < min_contrast_)
    return false;
  if (!plausibleShape(blob))
    return false;
  score = classify(blob);
  return score > min_detection_score_;
}

bool BlobFilter::plausibleShape(const Blob &blob) const {
  if (blob.width < min_face_width_)
    return false;
  const double aspect = blob.height / blob.width;
#ifdef IMAGE_CAPTURE_SHAPE_FAULT
  return aspect > min_aspect_ratio_ || aspect < max_aspect_ratio_;
#else
  return aspect > min_aspect_ratio_ && aspect < max_aspect_ratio_;
#endif
}

double BlobFilter::classify(const Blob &blob) {
  const double answer = blob.response + noise_(generator_);
  return answer < 0.0 ? 0.0 : answer > 1.0 ? 1.0 : answer;
}

} // namespace image_capture
