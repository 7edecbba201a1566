#include <composed_limits/limit.hpp>

namespace composed {
void Limit::set(double value) { value_ = value; }
bool Limit::is_passed_by(double value) const {
  return value > value_; // TPC min_light
}
} // namespace composed
