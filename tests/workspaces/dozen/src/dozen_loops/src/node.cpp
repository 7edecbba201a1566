#include "../include/dozen_loops/step.h"
#include <ros/ros.h>
#include <std_msgs/String.h>

int main(int argc, char **argv) {
  ros::init(argc, argv, SIDE "_node");
  ros::NodeHandle handle;
  double limit = 0;
  handle.param("limit", limit, 3.5);
  ros::Publisher publisher = handle.advertise<std_msgs::String>("out", 1);
  for (int i = 0; i < 8 && ros::ok(); ++i)
    step(publisher, i, limit);
}
