#pragma once

#define ROBOT_MIN_SPEED (-4.0)

namespace threshold_nodes {
namespace limits {

constexpr double kMaxSpeed = 4.0;
static const double max_jump = 6.0;
enum { MIN_SAMPLES = 3 };

struct Battery {
  static constexpr float kLow = -2.0f;
};

} // namespace limits
} // namespace threshold_nodes
