#include <cstdint>

#include <ros/ros.h>

#include "navigation/simulator_node.h"

int main(int argc, char **argv) {
  ros::init(argc, argv, "ground_simulator");
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  int seed = 1;
  private_nh.getParam("seed", seed);
  navigation::SimulatorNode node(nh, private_nh,
                                 static_cast<std::uint32_t>(seed));
  node.run(private_nh);
  return 0;
}
