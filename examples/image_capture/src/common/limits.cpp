#include "image_capture/limits.h"

#include <cmath>

namespace image_capture {

double clampMagnitude(double value, double limit) {
  if (value > limit)
    return limit;
  if (value < -limit)
    return -limit;
  return value;
}

double applyDeadband(double value, double width, bool collapse) {
  if (std::fabs(value) <= width)
    return 0.0;
  if (!collapse)
    return value;
  return value - std::copysign(width, value);
}

double wrapAngle(double angle) {
  while (angle > M_PI)
    angle -= 2.0 * M_PI;
  while (angle <= -M_PI)
    angle += 2.0 * M_PI;
  return angle;
}

double SlewLimiter::update(double target, double interval) {
  value_ += clampMagnitude(target - value_, rate_ * interval);
  return value_;
}

} // namespace image_capture
