// Small signal filters of the flight controller and the pump control.
#ifndef WATER_SAMPLER_FILTERS_H
#define WATER_SAMPLER_FILTERS_H

namespace water_sampler {

/// First-order low pass; the first sample is taken as it is.
class LowPass {
public:
  /// `share` is the weight of a new sample, 0 to 1.
  explicit LowPass(double share = 0.5) : share_(share) {}

  double update(double sample) {
    value_ = primed_ ? value_ + share_ * (sample - value_) : sample;
    primed_ = true;
    return value_;
  }
  void reset() { primed_ = false; }
  double value() const { return value_; }

private:
  double share_;
  double value_ = 0.0;
  bool primed_ = false;
};

/// The filtered slope of a signal, per s; 0 at the first sample.
class Slope {
public:
  explicit Slope(double share) : smooth_(share) {}

  double update(double sample, double interval) {
    const double change =
        primed_ && interval > 0.0 ? (sample - last_) / interval : 0.0;
    last_ = sample;
    primed_ = true;
    return smooth_.update(change);
  }

private:
  LowPass smooth_;
  double last_ = 0.0;
  bool primed_ = false;
};

} // namespace water_sampler

#endif // WATER_SAMPLER_FILTERS_H
