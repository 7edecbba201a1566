#include <ros/ros.h>

#include "navigation/localisation_node.h"

int main(int argc, char **argv) {
  ros::init(argc, argv, "localisation");
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  navigation::LocalisationNode node(nh, private_nh);
  ros::spin();
  return 0;
}
