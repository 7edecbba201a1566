#include <ros/ros.h>

#include "image_capture/detector_node.h"

int main(int argc, char **argv) {
  ros::init(argc, argv, "face_detector");
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  image_capture::DetectorNode node(nh, private_nh);
  ros::spin();
  return 0;
}
