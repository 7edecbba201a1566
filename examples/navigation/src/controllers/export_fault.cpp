// The same controller with a fault in its source: degrees are compared with
// radians, so that it is almost never satisfied with its heading.
#include <cmath>

#include <pluginlib/class_list_macros.hpp>

#include "navigation/pure_pursuit.h"

namespace navigation {

class PurePursuitFault : public PurePursuit {
protected:
  double misalignment() const override {
    return PurePursuit::misalignment() * 180.0 / M_PI;
  }
};

} // namespace navigation

PLUGINLIB_EXPORT_CLASS(navigation::PurePursuitFault, navigation::Controller)
