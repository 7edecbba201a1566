#include <ros/ros.h>

#include "navigation/recovery_node.h"

int main(int argc, char **argv) {
  ros::init(argc, argv, "recovery");
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  navigation::RecoveryNode node(nh, private_nh);
  ros::spin();
  return 0;
}
