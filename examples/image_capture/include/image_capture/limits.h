// Limits, dead bands and angles that several nodes share.
#ifndef IMAGE_CAPTURE_LIMITS_H
#define IMAGE_CAPTURE_LIMITS_H

namespace image_capture {

/// `value`, cut to [-limit, limit].
double clampMagnitude(double value, double limit);

/// 0 within `width` of 0. Outside, the value keeps its size or, with
/// `collapse`, is moved towards 0 by the width, so that the output has no step.
double applyDeadband(double value, double width, bool collapse);

/// The same angle in (-pi, pi].
double wrapAngle(double angle);

/// Follows its input with a limited slope.
class SlewLimiter {
public:
  /// `rate` is in units per s.
  explicit SlewLimiter(double rate = 1.0) : rate_(rate) {}

  void setRate(double rate) { rate_ = rate; }
  double update(double target, double interval);
  void reset(double value) { value_ = value; }

private:
  double rate_;
  double value_ = 0.0;
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_LIMITS_H
