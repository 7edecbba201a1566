#include <ros/ros.h>

#include "navigation/controller_host_node.h"

int main(int argc, char **argv) {
  ros::init(argc, argv, "controller_host");
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  navigation::ControllerHostNode node(nh, private_nh);
  ros::spin();
  return 0;
}
