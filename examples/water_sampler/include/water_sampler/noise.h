// Seeded noise for the simulator.
#ifndef WATER_SAMPLER_NOISE_H
#define WATER_SAMPLER_NOISE_H

#include <cmath>
#include <cstdint>
#include <random>

namespace water_sampler {

class Noise {
public:
  explicit Noise(std::uint32_t seed) : generator_(seed) {}

  double gaussian(double deviation) { return deviation * normal_(generator_); }
  double between(double low, double high) {
    return low + (high - low) * unit_(generator_);
  }
  bool chance(double probability) { return unit_(generator_) < probability; }

private:
  std::mt19937 generator_;
  std::normal_distribution<double> normal_{0.0, 1.0};
  std::uniform_real_distribution<double> unit_{0.0, 1.0};
};

/// Noise that remembers (Ornstein and Uhlenbeck), as gusts and drifts do.
class Drift {
public:
  /// `deviation` in the unit of the value, `memory` in s.
  Drift(double deviation, double memory)
      : deviation_(deviation), memory_(memory) {}

  double step(Noise &noise, double interval) {
    const double kept = std::exp(-interval / memory_);
    value_ = kept * value_ +
             noise.gaussian(deviation_ * std::sqrt(1.0 - kept * kept));
    return value_;
  }
  double value() const { return value_; }

private:
  double deviation_;
  double memory_;
  double value_ = 0.0;
};

} // namespace water_sampler

#endif // WATER_SAMPLER_NOISE_H
