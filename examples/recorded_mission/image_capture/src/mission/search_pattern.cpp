#include "image_capture/search_pattern.h"

#include <cmath>

#include "image_capture/limits.h"

namespace image_capture {

SearchPattern::SearchPattern(ros::NodeHandle &private_nh) {
  private_nh.param("search_yaw_rate", search_yaw_rate_, 0.35);
  private_nh.param("reacquire_delay", reacquire_delay_, 1.0);
  private_nh.param("max_search_rotations", max_search_rotations_, 3);
}

void SearchPattern::resume(double yaw, const ros::Time &now) {
  last_yaw_ = yaw;
  resumed_ = now;
}

void SearchPattern::advance(double yaw) {
  turned_ += std::fabs(wrapAngle(yaw - last_yaw_));
  last_yaw_ = yaw;
}

bool SearchPattern::looking(const ros::Time &now) const {
  return (now - resumed_).toSec() > reacquire_delay_;
}

bool SearchPattern::exhausted() const {
  return turned_ > 2.0 * M_PI * max_search_rotations_;
}

} // namespace image_capture
