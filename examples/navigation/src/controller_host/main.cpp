#include <ros/ros.h>

#include "navigation/controller_host_node.h"

int main(int argc, char **argv) {
  ros::init(argc, argv, "controller_host");
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  try {
    navigation::ControllerHostNode node(nh, private_nh);
    ros::spin();
  } catch (const pluginlib::PluginlibException &error) {
    ROS_FATAL("the controller cannot be loaded: %s", error.what());
    return 1;
  }
  return 0;
}
