#include <ros/ros.h>

#include "image_capture/mission_node.h"

int main(int argc, char **argv) {
  ros::init(argc, argv, "mission");
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  image_capture::MissionNode node(nh, private_nh);
  ros::spin();
  return 0;
}
