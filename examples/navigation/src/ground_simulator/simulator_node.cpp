#include "navigation/simulator_node.h"

#include <cmath>

#include <geometry_msgs/PoseStamped.h>
#include <navigation/ArenaTruth.h>
#include <simulated_world/truth.h>
#include <std_msgs/Float64.h>

namespace navigation {

namespace {
constexpr double TruthPeriod = 0.1;
constexpr double StatusPeriod = 0.1;
constexpr double HandshakePeriod = 0.1; // s, of the wall's clock
// The mark on the floor, and how close to it the lamp may be lit.
constexpr Pose Goal = {6.6, 4.8, M_PI / 2.0};
constexpr double SignalRadius = 0.4; // m
} // namespace

SimulatorNode::SimulatorNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh,
                             std::uint32_t seed)
    : clock_(nh), arena_(private_nh, seed + 1000u), base_(private_nh, seed) {
  private_nh.param("rate", rate_, 4.0);
  private_nh.param("scan_period", scan_period_, 0.1);
  private_nh.param("odometry_period", odometry_period_, 0.05);
  private_nh.param("max_command_lag", max_command_lag_, 0.05);
  odometry_pub_ = nh.advertise<nav_msgs::Odometry>("/odom", 10);
  scan_pub_ = nh.advertise<sensor_msgs::LaserScan>("/scan", 10);
  status_pub_ = nh.advertise<RobotStatus>("/robot/status", 10);
  robot_truth_pub_ =
      nh.advertise<geometry_msgs::PoseStamped>("/truth/robot", 100);
  goal_truth_pub_ =
      nh.advertise<geometry_msgs::PoseStamped>("/truth/goal", 1, true);
  arena_truth_pub_ = nh.advertise<ArenaTruth>("/truth/events", 100);
  signalled_pub_ =
      nh.advertise<std_msgs::Float64>("/truth/goal_signalled", 2, true);
  const auto hints = ros::TransportHints().tcpNoDelay();
  command_sub_ = nh.subscribe("/robot/cmd_vel", 10, &SimulatorNode::onCommand,
                              this, hints);
  mission_sub_ = nh.subscribe("/mission/command", 10, &SimulatorNode::onMission,
                              this, hints);
  plan_sub_ =
      nh.subscribe("/planner/status", 10, &SimulatorNode::onPlan, this, hints);
  lamp_sub_ = nh.subscribe("/mission/lamp", 10, &SimulatorNode::onLamp, this);
  horn_sub_ = nh.subscribe("/mission/horn", 10, &SimulatorNode::onHorn, this);
}

void SimulatorNode::run(ros::NodeHandle &private_nh) {
  double max_duration = 600.0;
  private_nh.getParam("max_duration", max_duration);
  waitForNodes();
  goal_truth_pub_.publish(
      simulated_world::poseAt(clock_.stamp(), Goal.x, Goal.y, 0.0, Goal.yaw));
  while (ros::ok()) {
    ros::spinOnce();
    if (clock_.every(1.0) && clock_.now() > max_duration)
      break;
    tick();
    drive_.hold(max_command_lag_);
    planner_.hold(max_command_lag_);
    mission_.hold(max_command_lag_);
    clock_.keepPace(rate_);
  }
}

void SimulatorNode::waitForNodes() {
  // The first moment lasts until all nodes that decide have answered to it: they
  // start one after the other, and the mission must not begin before the last.
  clock_.advance();
  const ros::Time stamp = clock_.stamp();
  const RobotStatus status = base_.status(stamp);
  const nav_msgs::Odometry odometry = base_.odometry(stamp);
  const sensor_msgs::LaserScan scan = arena_.scan(stamp, base_.pose());
  while (ros::ok() &&
         !(drive_.begun() && planner_.begun() && mission_.begun())) {
    status_pub_.publish(status);
    odometry_pub_.publish(odometry);
    scan_pub_.publish(scan);
    ros::WallDuration(HandshakePeriod).sleep();
    ros::spinOnce();
  }
}

void SimulatorNode::tick() {
  clock_.advance();
  const ros::Time stamp = clock_.stamp();
  arena_.step(base_.pose(), clock_.Step);
  base_.step(command_, arena_, clock_.Step);
  contact_ = contact_ || base_.contact();
  sense(stamp);
  if (clock_.every(TruthPeriod))
    publishTruth(stamp);
}

void SimulatorNode::sense(const ros::Time &stamp) {
  if (clock_.every(StatusPeriod))
    status_pub_.publish(base_.status(stamp));
  if (clock_.every(odometry_period_))
    odometry_pub_.publish(base_.odometry(stamp));
  if (!clock_.every(scan_period_))
    return;
  // They all pass on the stamp of the scan that they are based on.
  drive_.sent(stamp);
  planner_.sent(stamp);
  mission_.sent(stamp);
  scan_pub_.publish(arena_.scan(stamp, base_.pose()));
}

void SimulatorNode::onCommand(const geometry_msgs::TwistStamped &command) {
  command_ = command.twist;
  drive_.answered(command.header.stamp);
}

void SimulatorNode::onMission(const MissionCommand &command) {
  mission_.answered(command.header.stamp);
}

void SimulatorNode::onPlan(const PlanStatus &status) {
  planner_.answered(status.header.stamp);
}

void SimulatorNode::onLamp(const std_msgs::Bool &lamp) { lamp_ = lamp.data; }

void SimulatorNode::onHorn(const std_msgs::Bool &horn) { horn_ = horn.data; }

void SimulatorNode::publishTruth(const ros::Time &stamp) {
  const Pose &robot = base_.pose();
  robot_truth_pub_.publish(
      simulated_world::poseAt(stamp, robot.x, robot.y, 0.0, robot.yaw));
  ArenaTruth arena;
  arena.header.stamp = stamp;
  arena.cart_x = arena_.cart().place().x;
  arena.cart_y = arena_.cart().place().y;
  arena.contact = contact_;
  arena.lamp = lamp_;
  arena.horn = horn_;
  contact_ = false;
  arena_truth_pub_.publish(arena);
  const double away = std::hypot(robot.x - Goal.x, robot.y - Goal.y);
  if (signalled_ || !lamp_ || away > SignalRadius)
    return;
  signalled_ = true;
  std_msgs::Float64 distance;
  distance.data = away;
  signalled_pub_.publish(distance);
}

} // namespace navigation
