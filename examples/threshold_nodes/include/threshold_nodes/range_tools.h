#pragma once

namespace threshold_nodes {

template <typename T> bool exceeds(const T &value, const T &limit) {
  return value > limit;
}

/// The value, but not above cap.
inline double saturate(double value, double cap) {
  if (value > cap)
    return cap;
  return value;
}

/// Lets a signal rise by no more than step at a time.
class Ramp {
public:
  explicit Ramp(double step) : step_(step) {}

  double limit(double value) {
    if (value - last_ > step_)
      value = last_ + step_;
    last_ = value;
    return value;
  }

private:
  double step_;
  double last_ = 0.0;
};

} // namespace threshold_nodes
