#include "navigator.h"

int main(int argc, char **argv) {
  ros::init(argc, argv, "heavy_robot");
  tf2_ros::Buffer transforms(ros::Duration(10));
  tf2_ros::TransformListener listener(transforms);
  heavy::Navigator navigator(transforms);
  ros::spin();
}
