// Owns the simulated time: moves the robot and the cart, publishes /clock, the
// sensors, and the truth that an observer sees.
#ifndef NAVIGATION_SIMULATOR_NODE_H
#define NAVIGATION_SIMULATOR_NODE_H

#include <cstdint>

#include <geometry_msgs/TwistStamped.h>
#include <navigation/MissionCommand.h>
#include <navigation/PlanStatus.h>
#include <ros/ros.h>
#include <simulated_world/simulated_clock.h>
#include <std_msgs/Bool.h>

#include "navigation/arena.h"
#include "navigation/robot_base.h"

namespace navigation {

class SimulatorNode {
public:
  SimulatorNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh,
                std::uint32_t seed);

  /// Until ROS shuts down, or `max_duration` (s, simulated) is over.
  void run(ros::NodeHandle &private_nh);

private:
  void onCommand(const geometry_msgs::TwistStamped &command);
  void onMission(const MissionCommand &command);
  void onPlan(const PlanStatus &status);
  void onLamp(const std_msgs::Bool &lamp);
  void onHorn(const std_msgs::Bool &horn);
  void waitForNodes();
  void tick();
  void sense(const ros::Time &stamp);
  void publishTruth(const ros::Time &stamp);

  simulated_world::SimulatedClock clock_;
  simulated_world::Lockstep drive_, mission_, planner_;
  Arena arena_;
  RobotBase base_;
  ros::Publisher odometry_pub_, scan_pub_, status_pub_;
  ros::Publisher robot_truth_pub_, goal_truth_pub_, arena_truth_pub_;
  ros::Publisher signalled_pub_;
  ros::Subscriber command_sub_, mission_sub_, plan_sub_, lamp_sub_, horn_sub_;

  geometry_msgs::Twist command_;
  double rate_;
  double scan_period_;
  double odometry_period_;
  double max_command_lag_;
  bool contact_ = false; ///< since it was told last
  bool lamp_ = false;
  bool horn_ = false;
  bool signalled_ = false;
};

} // namespace navigation

#endif // NAVIGATION_SIMULATOR_NODE_H
