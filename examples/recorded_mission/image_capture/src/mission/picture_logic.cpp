#include "image_capture/picture_logic.h"

#include <cmath>

namespace image_capture {

PictureLogic::PictureLogic(ros::NodeHandle &private_nh) {
  private_nh.param("min_coverage_limit", min_coverage_limit_, 0.035);
  private_nh.param("max_coverage_limit", max_coverage_limit_, 0.2);
  private_nh.param("center_tolerance", center_tolerance_, 0.25);
  private_nh.param("capture_cooldown", capture_cooldown_, 2.0);
  private_nh.param("standoff_distance", standoff_distance_, 2.2);
  private_nh.param("max_selfie_count", max_selfie_count_, 1);
  private_nh.param("max_capture_attempts", max_capture_attempts_, 3);
}

bool PictureLogic::coverageInRange(double coverage) const {
#ifdef IMAGE_CAPTURE_RANGE_FAULT
  return coverage > min_coverage_limit_ && coverage > max_coverage_limit_;
#else
  return coverage > min_coverage_limit_ && coverage < max_coverage_limit_;
#endif
}

bool PictureLogic::centred(double offset_x) const {
  return std::fabs(offset_x) < center_tolerance_;
}

bool PictureLogic::needsMove(double coverage, double &distance) const {
  if (coverage < min_coverage_limit_) {
    distance = standoff_distance_;
    return true;
  }
  if (coverage > max_coverage_limit_) {
    distance = 1.5 * standoff_distance_;
    return true;
  }
  return false;
}

bool PictureLogic::mayCapture(const ros::Time &now) const {
  if (selfies_ >= max_selfie_count_)
    return false;
  return selfies_ == 0 || (now - last_capture_).toSec() > capture_cooldown_;
}

bool PictureLogic::mayRetry(int attempts) const {
  return attempts < max_capture_attempts_;
}

void PictureLogic::noteCapture(const ros::Time &now) {
  ++selfies_;
  last_capture_ = now;
}

bool PictureLogic::albumFull() const { return selfies_ >= max_selfie_count_; }

std::vector<std::uint8_t> PictureLogic::album() const {
  std::vector<std::uint8_t> slots;
  for (int slot = 0; slot < max_selfie_count_; ++slot)
    slots.push_back(slot < selfies_ ? 1 : 0);
  return slots;
}

} // namespace image_capture
