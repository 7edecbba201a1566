// Seeded noise for the simulators.
#ifndef SIMULATED_WORLD_NOISE_H
#define SIMULATED_WORLD_NOISE_H

#include <cmath>
#include <cstdint>
#include <random>

namespace simulated_world {

class Noise {
public:
  explicit Noise(std::uint32_t seed) : generator_(seed) {}

  double gaussian(double deviation) { return deviation * normal_(generator_); }
  double uniform(double low, double high) {
    return low + (high - low) * unit_(generator_);
  }
  bool chance(double probability) {
    return std::bernoulli_distribution(probability)(generator_);
  }
  int poisson(double mean) {
    return std::poisson_distribution<int>(mean)(generator_);
  }
  /// The time to the next event of a Poisson process, for its mean in s.
  double waitingTime(double mean) {
    return -mean * std::log1p(-unit_(generator_));
  }

private:
  std::mt19937 generator_;
  std::normal_distribution<double> normal_{0.0, 1.0};
  std::uniform_real_distribution<double> unit_{0.0, 1.0};
};

/// Noise with a memory (Ornstein and Uhlenbeck): gusts, drift of a barometer.
class SlowNoise {
public:
  /// `deviation` in the unit of the value, `time_constant` in s.
  SlowNoise(double deviation, double time_constant)
      : deviation_(deviation), time_constant_(time_constant) {}

  void setDeviation(double deviation) { deviation_ = deviation; }

  double step(Noise &noise, double interval) {
    const double keep = std::exp(-interval / time_constant_);
    value_ = keep * value_ +
             noise.gaussian(deviation_ * std::sqrt(1.0 - keep * keep));
    return value_;
  }
  double value() const { return value_; }

private:
  double deviation_;
  double time_constant_;
  double value_ = 0.0;
};

} // namespace simulated_world

#endif // SIMULATED_WORLD_NOISE_H
