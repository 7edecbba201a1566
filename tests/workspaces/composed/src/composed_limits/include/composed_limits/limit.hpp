#ifndef COMPOSED_LIMITS_LIMIT_HPP
#define COMPOSED_LIMITS_LIMIT_HPP

namespace composed {
class Limit {
public:
  void set(double value);
  bool is_passed_by(double value) const;

private:
  double value_ = 0;
};
} // namespace composed

#endif
