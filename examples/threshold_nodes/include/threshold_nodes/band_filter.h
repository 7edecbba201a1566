#ifndef THRESHOLD_NODES_BAND_FILTER_H
#define THRESHOLD_NODES_BAND_FILTER_H

#include <utility>

namespace threshold_nodes {

/// Lets values inside [low, high] pass and counts those outside.
template <typename T> class BandFilter {
public:
  BandFilter(T low, T high) : low_(std::move(low)), high_(std::move(high)) {}

  bool pass(const T &value) {
    if (value < low_ || value > high_) {
      ++rejected_;
      return false;
    }
    return true;
  }

  unsigned rejected() const { return rejected_; }

private:
  T low_;
  T high_;
  unsigned rejected_ = 0;
};

} // namespace threshold_nodes

#endif // THRESHOLD_NODES_BAND_FILTER_H
