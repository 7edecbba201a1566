// The interface of a controller plugin: the controller host loads one by its name.
#ifndef NAVIGATION_CONTROLLER_H
#define NAVIGATION_CONTROLLER_H

#include <vector>

#include <geometry_msgs/Twist.h>
#include <navigation/Localised.h>
#include <ros/ros.h>

#include "navigation/floor_plan.h"

namespace navigation {

class Controller {
public:
  virtual ~Controller() = default;
  /// Called once: `private_nh` has its parameters.
  virtual void initialize(ros::NodeHandle &nh, ros::NodeHandle &private_nh) = 0;
  /// A path to a new goal, or a new path to the same goal; the last pose is the
  /// goal.
  virtual void setPath(const std::vector<Pose> &path,
                       std::uint32_t goal_id) = 0;
  /// The velocity to drive at the time of `robot`.
  virtual geometry_msgs::Twist compute(const Localised &robot) = 0;
};

} // namespace navigation

#endif // NAVIGATION_CONTROLLER_H
