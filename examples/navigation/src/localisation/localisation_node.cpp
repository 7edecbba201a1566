#include "navigation/localisation_node.h"

#include <cmath>

namespace navigation {

namespace {
constexpr double QualityShare = 0.1; // of a new frame in the smoothed quality

Pose countedPose(const nav_msgs::Odometry &odometry) {
  const auto &pose = odometry.pose.pose;
  return {pose.position.x, pose.position.y,
          2.0 * std::atan2(pose.orientation.z, pose.orientation.w)};
}
} // namespace

Confidence::Confidence(ros::NodeHandle &private_nh) {
  private_nh.param("min_quality", min_quality_, 0.35);
  private_nh.param("lost_frames", lost_frames_, 12);
  private_nh.param("good_frames", good_frames_, 8);
}

void Confidence::update(const Match &match) {
  quality_ += QualityShare * (match.fit - quality_);
  rejected_ = match.accepted ? 0 : rejected_ + 1;
  accepted_ = match.accepted ? accepted_ + 1 : 0;
  if (rejected_ >= lost_frames_)
    lost_ = true;
  else if (accepted_ >= good_frames_)
    lost_ = false;
  ready_ = !lost_;
  if (quality_ < min_quality_)
    ready_ = false;
}

LocalisationNode::LocalisationNode(ros::NodeHandle &nh,
                                   ros::NodeHandle &private_nh)
    : matcher_(private_nh), confidence_(private_nh) {
  private_nh.param("max_odometry_step", max_odometry_step_, 0.25);
  private_nh.param("max_match_turn_rate", max_match_turn_rate_, 1.6);
  private_nh.param("enable_matching", enable_matching_, true);
  pose_pub_ = nh.advertise<Localised>("/localisation/pose", 10);
  const auto hints = ros::TransportHints().tcpNoDelay();
  odometry_sub_ =
      nh.subscribe("/odom", 10, &LocalisationNode::onOdometry, this, hints);
  scan_sub_ = nh.subscribe("/scan", 10, &LocalisationNode::onScan, this, hints);
}

void LocalisationNode::onOdometry(const nav_msgs::Odometry &odometry) {
  odometry_ = odometry;
  takeIn();
}

void LocalisationNode::onScan(const sensor_msgs::LaserScan &scan) {
  scan_ = scan;
  scan_pending_ = true;
  takeIn();
}

void LocalisationNode::takeIn() {
  // The odometry for the time of the scan comes by another connection.
  if (!scan_pending_ || odometry_.header.stamp < scan_.header.stamp)
    return;
  scan_pending_ = false;
  predict();
  Match match;
  match.pose = pose_;
  const double turn_rate = std::fabs(odometry_.twist.twist.angular.z);
  // In a fast turn the scan is distorted.
  if (enable_matching_ && turn_rate < max_match_turn_rate_)
    match = matcher_.match(pose_, scan_);
  pose_ = match.pose;
  confidence_.update(match);
  publish(scan_.header.stamp);
}

void LocalisationNode::predict() {
  const Pose now = countedPose(odometry_);
  const double dx = now.x - counted_.x, dy = now.y - counted_.y;
  // Nobody drove a longer step: the counter was reset.
  const bool driven = begun_ && std::hypot(dx, dy) < max_odometry_step_;
  if (driven) {
    const double c = std::cos(pose_.yaw - counted_.yaw);
    const double s = std::sin(pose_.yaw - counted_.yaw);
    pose_.x += c * dx - s * dy;
    pose_.y += s * dx + c * dy;
    pose_.yaw = wrapAngle(pose_.yaw + now.yaw - counted_.yaw);
  }
  counted_ = now;
  begun_ = true;
}

void LocalisationNode::publish(const ros::Time &stamp) {
  Localised localised;
  localised.header.stamp = stamp;
  localised.x = pose_.x;
  localised.y = pose_.y;
  localised.yaw = pose_.yaw;
  localised.speed = odometry_.twist.twist.linear.x;
  localised.turn_rate = odometry_.twist.twist.angular.z;
  localised.quality = confidence_.quality();
  localised.ready = confidence_.ready();
  localised.lost = confidence_.lost();
  pose_pub_.publish(localised);
}

} // namespace navigation
