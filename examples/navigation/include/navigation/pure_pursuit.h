// Follows a point that moves ahead along the path.
#ifndef NAVIGATION_PURE_PURSUIT_H
#define NAVIGATION_PURE_PURSUIT_H

#include "navigation/controller.h"

namespace navigation {

/// Pure pursuit (Coulter 1992); at the goal it turns to the goal's heading.
class PurePursuit : public Controller {
public:
  void initialize(ros::NodeHandle &nh, ros::NodeHandle &private_nh) override;
  void setPath(const std::vector<Pose> &path, std::uint32_t goal_id) override;
  geometry_msgs::Twist compute(const Localised &robot) override;

protected:
  /// The angle between the robot's heading and that of the goal, rad.
  virtual double misalignment() const;

  double heading_error_ = 0.0;

private:
  Point target(const Point &robot) const;
  geometry_msgs::Twist follow(const Localised &robot, double distance);
  geometry_msgs::Twist align();
  geometry_msgs::Twist turnTo(double heading_error);
  double limitedTurn(double turn_rate) const;
  void publish(const Localised &robot, const geometry_msgs::Twist &twist);

  ros::Publisher status_pub_;
  std::vector<Pose> path_;
  std::uint32_t goal_id_ = 0;
  double lookahead_;
  double cruise_speed_;
  double slow_down_distance_;
  double min_speed_;
  double goal_tolerance_;
  double heading_tolerance_;
  double turn_in_place_angle_;
  double turn_exit_angle_;
  double max_turn_rate_;
  double min_turn_rate_;
  double sharp_curvature_;
  double sharp_speed_;
  int aligned_frames_;
  int aligned_ = 0; ///< frames in succession
  bool turn_at_goal_;
  bool turning_ = false;
  bool near_goal_ = false;
  bool arrived_ = false;
  double distance_ = 0.0;
  double bearing_ = 0.0;
};

} // namespace navigation

#endif // NAVIGATION_PURE_PURSUIT_H
