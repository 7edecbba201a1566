#include <ros/ros.h>

#include "image_capture/radio_node.h"

int main(int argc, char **argv) {
  ros::init(argc, argv, "radio_link");
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  image_capture::RadioNode node(nh, private_nh);
  ros::spin();
  return 0;
}
