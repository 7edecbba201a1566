#include <ros/ros.h>

#include "water_sampler/controller_node.h"

int main(int argc, char **argv) {
  ros::init(argc, argv, "flight_controller");
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  water_sampler::ControllerNode node(nh, private_nh);
  ros::spin();
  return 0;
}
