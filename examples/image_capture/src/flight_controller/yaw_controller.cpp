#include <cmath>

#include "image_capture/axis_controllers.h"

namespace image_capture {

YawController::YawController(ros::NodeHandle &private_nh) {
  private_nh.param("max_yaw_rate", max_yaw_rate_, 1.0);
  private_nh.param("max_yaw_acceleration", max_yaw_acceleration_, 4.0);
  private_nh.param("enable_yaw_ctrl", enable_yaw_ctrl_, true);
  slew_.setRate(max_yaw_acceleration_);
}

double YawController::update(const Estimate &estimate, const Target &target) {
  if (!enable_yaw_ctrl_)
    return 0.0;
  double rate = target.turn ? target.yaw_rate
                            : yaw_gain_ * wrapAngle(target.yaw - estimate.yaw);
  if (std::fabs(rate) > max_yaw_rate_)
    rate = std::copysign(max_yaw_rate_, rate);
  return slew_.update(rate, estimate.interval);
}

} // namespace image_capture
