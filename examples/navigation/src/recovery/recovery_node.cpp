#include "navigation/recovery_node.h"

#include <cmath>

namespace navigation {

RecoveryNode::RecoveryNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh)
    : watch_(private_nh) {
  private_nh.param("rest_time", rest_time_, 0.5);
  private_nh.param("backup_speed", backup_speed_, 0.2);
  private_nh.param("turn_speed", turn_speed_, 0.9);
  private_nh.param("action_timeout", action_timeout_, 5.0);
  private_nh.param("lost_patience", lost_patience_, 0.25);
  private_nh.param("bumper_frames", bumper_frames_, 3);
  private_nh.param("max_recoveries", max_recoveries_, 6);
  private_nh.param("spin_when_lost", spin_when_lost_, true);
  double backup_distance_cm, turn_angle_deg, spin_angle_deg;
  private_nh.param("backup_distance_cm", backup_distance_cm, 30.0);
  private_nh.param("turn_angle_deg", turn_angle_deg, 40.0);
  private_nh.param("spin_angle_deg", spin_angle_deg, 330.0);
  backup_distance_ = backup_distance_cm / 100.0;
  turn_angle_ = turn_angle_deg * M_PI / 180.0;
  spin_angle_ = spin_angle_deg * M_PI / 180.0;
  command_pub_ =
      nh.advertise<geometry_msgs::TwistStamped>("/recovery/cmd_vel", 10);
  status_pub_ = nh.advertise<RecoveryStatus>("/recovery/status", 10);
  const auto hints = ros::TransportHints().tcpNoDelay();
  pose_sub_ = nh.subscribe("/localisation/pose", 10, &RecoveryNode::onPose,
                           this, hints);
  status_sub_ =
      nh.subscribe("/robot/status", 10, &RecoveryNode::onStatus, this, hints);
  mission_sub_ = nh.subscribe("/mission/command", 10, &RecoveryNode::onMission,
                              this, hints);
  command_sub_ = nh.subscribe("/controller/cmd_vel", 10,
                              &RecoveryNode::onCommand, this, hints);
}

void RecoveryNode::onPose(const Localised &pose) {
  pose_ = {pose.x, pose.y, pose.yaw};
  if (pose.lost && !lost_)
    lost_since_ = pose.header.stamp;
  lost_ = pose.lost;
  pose_stamp_ = pose.header.stamp;
  takeIn();
}

void RecoveryNode::onStatus(const RobotStatus &status) {
  touching_ = status.bumper ? touching_ + 1 : 0;
}

void RecoveryNode::onMission(const MissionCommand &command) {
  if (command.goal_id == goal_id_)
    return;
  goal_id_ = command.goal_id;
  recoveries_ = 0;
  given_up_ = false;
}

void RecoveryNode::onCommand(const geometry_msgs::TwistStamped &command) {
  command_ = command;
  command_pending_ = true;
  takeIn();
}

void RecoveryNode::takeIn() {
  // The pose that the command is based on comes by another connection.
  if (!command_pending_ || pose_stamp_ < command_.header.stamp)
    return;
  command_pending_ = false;
  const ros::Time now = command_.header.stamp;
  turned_ += std::fabs(wrapAngle(pose_.yaw - last_yaw_));
  last_yaw_ = pose_.yaw;
  decide(command_.twist, now);
  geometry_msgs::TwistStamped out = command_;
  if (given_up_)
    out.twist = geometry_msgs::Twist();
  else if (action_ != RecoveryStatus::NONE)
    out.twist = act(now);
  command_pub_.publish(out);
  RecoveryStatus status;
  status.header.stamp = now;
  status.goal_id = goal_id_;
  status.action = action_;
  status.recoveries = static_cast<std::uint32_t>(recoveries_);
  status.given_up = given_up_;
  status_pub_.publish(status);
}

void RecoveryNode::decide(const geometry_msgs::Twist &wanted,
                          const ros::Time &now) {
  if (action_ != RecoveryStatus::NONE)
    return;
  if (lost_ && spin_when_lost_ &&
      (now - lost_since_).toSec() > lost_patience_) {
    begin(RecoveryStatus::SPIN, now);
    return;
  }
  const bool stuck = watch_.stuck(pose_, wanted, now);
  if (!stuck && touching_ < bumper_frames_)
    return;
  ++recoveries_;
  if (recoveries_ > max_recoveries_)
    given_up_ = true;
  begin(RecoveryStatus::REST, now);
}

void RecoveryNode::begin(std::uint8_t action, const ros::Time &now) {
  action_ = action;
  begun_ = now;
  begun_at_ = pose_;
  turned_ = 0.0;
}

geometry_msgs::Twist RecoveryNode::act(const ros::Time &now) {
  geometry_msgs::Twist twist;
  const double age = (now - begun_).toSec();
  switch (action_) {
  case RecoveryStatus::REST:
    if (age > rest_time_)
      begin(RecoveryStatus::BACK_UP, now);
    break;
  case RecoveryStatus::BACK_UP:
    twist.linear.x = -backup_speed_;
    if (backedUp(age))
      begin(RecoveryStatus::TURN, now);
    break;
  case RecoveryStatus::TURN:
    twist.angular.z = turn_speed_;
    if (turned_ > turn_angle_ || age > action_timeout_)
      finish(now);
    break;
  case RecoveryStatus::SPIN:
    twist.angular.z = turn_speed_;
    if (turned_ > spin_angle_ && !lost_)
      finish(now);
    break;
  default:
    break;
  }
  return twist;
}

bool RecoveryNode::backedUp(double age) const {
  const double backed =
      std::hypot(pose_.x - begun_at_.x, pose_.y - begun_at_.y);
  return backed > backup_distance_ || age > action_timeout_;
}

void RecoveryNode::finish(const ros::Time &now) {
  action_ = RecoveryStatus::NONE;
  touching_ = 0;
  watch_.reset(pose_, now);
}

} // namespace navigation
