extern "C" {
#include "level.h"
}
#include <ros/ros.h>
#include <std_msgs/Float64.h>

int main(int argc, char **argv) {
  ros::init(argc, argv, "c_node");
  ros::NodeHandle handle;
  level needed;
  handle.param("least", needed.least, 2.0);
  ros::Publisher publisher = handle.advertise<std_msgs::Float64>("out", 1);
  for (int i = 0; i < 8; ++i)
    if (enough(&needed, i)) {
      std_msgs::Float64 message;
      message.data = i;
      publisher.publish(message);
    }
}
