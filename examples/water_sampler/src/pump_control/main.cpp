#include <ros/ros.h>

#include "water_sampler/pump_node.h"

int main(int argc, char **argv) {
  ros::init(argc, argv, "pump_control");
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  water_sampler::PumpNode node(nh, private_nh);
  ros::spin();
  return 0;
}
