// Has the last word on the command to the wheels.
#ifndef NAVIGATION_SAFETY_NODE_H
#define NAVIGATION_SAFETY_NODE_H

#include <string>

#include <geometry_msgs/TwistStamped.h>
#include <navigation/RobotStatus.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>

namespace navigation {

class SafetyNode {
public:
  SafetyNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh);

private:
  void onScan(const sensor_msgs::LaserScan &scan);
  void onStatus(const RobotStatus &status);
  void onCommand(const geometry_msgs::TwistStamped &command);
  void onHousekeeping(const ros::TimerEvent &event);
  void takeIn();
  /// Why the wheels must stand still, or an empty string.
  std::string reasonToStand(const ros::Time &now);
  void guardFront(geometry_msgs::Twist &twist);
  void guardRear(geometry_msgs::Twist &twist) const;
  void publish(const ros::Time &stamp, const geometry_msgs::Twist &twist);

  ros::Publisher command_pub_, status_pub_;
  ros::Subscriber scan_sub_, status_sub_, command_sub_;
  ros::Timer housekeeping_timer_;
  sensor_msgs::LaserScan scan_;
  RobotStatus status_;
  geometry_msgs::TwistStamped command_;
  ros::Time touched_;
  std::string reason_;
  double stop_distance_;
  double release_distance_;
  double slow_distance_;
  double slow_share_; ///< of the speed that is wanted
  double side_distance_;
  double side_share_;
  double rear_distance_;
  double scan_timeout_;
  double status_timeout_;
  double command_timeout_;
  double bumper_hold_;
  double min_voltage_;
  double max_tilt_;
  int weak_samples_;
  int tilt_samples_;
  bool enable_front_guard_;
  double front_ = 0.0, side_ = 0.0, rear_ = 0.0; ///< clearances, m
  double voltage_ = 0.0;                         ///< smoothed
  int weak_ = 0;                                 ///< samples in succession
  int tilted_ = 0;
  bool blocked_ = false;
  bool command_pending_ = false;
};

} // namespace navigation

#endif // NAVIGATION_SAFETY_NODE_H
