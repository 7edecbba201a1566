#include <ros/ros.h>

#include "navigation/safety_node.h"

int main(int argc, char **argv) {
  ros::init(argc, argv, "safety_stop");
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  navigation::SafetyNode node(nh, private_nh);
  ros::spin();
  return 0;
}
