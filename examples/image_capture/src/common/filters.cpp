#include "image_capture/filters.h"

namespace image_capture {

double IirLowPass::update(double sample) {
  if (!primed_) {
    value_ = sample;
    primed_ = true;
    return value_;
  }
  value_ += alpha_ * (sample - value_);
  return value_;
}

double FirDerivative::update(double sample, double interval) {
  for (std::size_t i = 0; i + 1 < Taps; ++i)
    samples_[i] = samples_[i + 1];
  samples_[Taps - 1] = sample;
  if (filled_ < Taps) {
    ++filled_;
    return 0.0;
  }
  if (interval <= 0.0)
    return 0.0;
  // The line through five equally spaced points has the slope
  // (-2 a - b + d + 2 e) / 10 per interval.
  const double slope =
      2.0 * (samples_[4] - samples_[0]) + (samples_[3] - samples_[1]);
  return slope / (10.0 * interval);
}

double Difference::update(double sample, double interval) {
  const double change = sample - last_;
  last_ = sample;
  if (!primed_ || interval <= 0.0) {
    primed_ = true;
    return 0.0;
  }
  return change / interval;
}

} // namespace image_capture
