// Helps the robot if it is stuck, touches something or is lost; otherwise
// passes on the command of the controller.
#ifndef NAVIGATION_RECOVERY_NODE_H
#define NAVIGATION_RECOVERY_NODE_H

#include <geometry_msgs/TwistStamped.h>
#include <navigation/Localised.h>
#include <navigation/MissionCommand.h>
#include <navigation/RecoveryStatus.h>
#include <navigation/RobotStatus.h>
#include <ros/ros.h>

#include "navigation/floor_plan.h"

namespace navigation {

/// Knows since when the robot has not moved although it was told to.
class StuckWatch {
public:
  explicit StuckWatch(ros::NodeHandle &private_nh);

  bool stuck(const Pose &pose, const geometry_msgs::Twist &wanted,
             const ros::Time &now);
  void reset(const Pose &pose, const ros::Time &now);

private:
  double stuck_time_;
  double stuck_distance_;
  double stuck_turn_;
  double min_command_;
  double min_turn_command_;
  Pose anchor_;
  ros::Time since_;
};

class RecoveryNode {
public:
  RecoveryNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh);

private:
  void onPose(const Localised &pose);
  void onStatus(const RobotStatus &status);
  void onMission(const MissionCommand &command);
  void onCommand(const geometry_msgs::TwistStamped &command);
  void takeIn();
  void begin(std::uint8_t action, const ros::Time &now);
  void decide(const geometry_msgs::Twist &wanted, const ros::Time &now);
  geometry_msgs::Twist act(const ros::Time &now);
  bool backedUp(double age) const;
  void finish(const ros::Time &now);

  StuckWatch watch_;
  ros::Publisher command_pub_, status_pub_;
  ros::Subscriber pose_sub_, status_sub_, mission_sub_, command_sub_;
  Pose pose_, begun_at_;
  geometry_msgs::TwistStamped command_;
  ros::Time pose_stamp_, begun_, lost_since_;
  double last_yaw_ = 0.0;
  double turned_ = 0.0; ///< in this action, rad
  double rest_time_;
  double backup_distance_;
  double backup_speed_;
  double turn_angle_;
  double spin_angle_;
  double turn_speed_;
  double action_timeout_;
  double lost_patience_;
  int bumper_frames_;
  int max_recoveries_;
  bool spin_when_lost_;
  std::uint32_t goal_id_ = 0;
  int recoveries_ = 0; ///< on the way to this goal
  int touching_ = 0;   ///< frames in succession
  bool lost_ = false;
  bool given_up_ = false;
  bool command_pending_ = false;
  std::uint8_t action_ = RecoveryStatus::NONE;
};

} // namespace navigation

#endif // NAVIGATION_RECOVERY_NODE_H
