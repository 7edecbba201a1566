#include <ros/ros.h>

#include "navigation/planner_node.h"

int main(int argc, char **argv) {
  ros::init(argc, argv, "planner");
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  navigation::PlannerNode node(nh, private_nh);
  ros::spin();
  return 0;
}
