// Small signal filters that several nodes share.
#ifndef IMAGE_CAPTURE_FILTERS_H
#define IMAGE_CAPTURE_FILTERS_H

#include <array>
#include <cstddef>

namespace image_capture {

/// First-order low pass, y += alpha * (x - y). The first sample is taken as is.
class IirLowPass {
public:
  explicit IirLowPass(double alpha = 0.5) : alpha_(alpha) {}

  void setAlpha(double alpha) { alpha_ = alpha; }
  double update(double sample);
  void reset() { primed_ = false; }
  bool primed() const { return primed_; }
  double value() const { return value_; }

private:
  double alpha_;
  double value_ = 0.0;
  bool primed_ = false;
};

/// Derivative by a least squares line through the last five samples: a third of
/// the noise of a plain difference, for two samples of delay.
class FirDerivative {
public:
  /// `interval` is the time between samples in s; 0 until five have come.
  double update(double sample, double interval);
  void reset() { filled_ = 0; }

private:
  static constexpr std::size_t Taps = 5;
  std::array<double, Taps> samples_{};
  std::size_t filled_ = 0;
};

/// The plain difference of two successive samples over their interval.
class Difference {
public:
  double update(double sample, double interval);
  void reset() { primed_ = false; }

private:
  double last_ = 0.0;
  bool primed_ = false;
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_FILTERS_H
