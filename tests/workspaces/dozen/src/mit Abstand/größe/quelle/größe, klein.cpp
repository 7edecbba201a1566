#include <ros/ros.h>
#include <std_msgs/Bool.h>

int main(int argc, char **argv) {
  ros::init(argc, argv, "odd_node");
  ros::NodeHandle handle;
  double size;
  handle.param("größe", size, 0.5);
  ros::Publisher publisher = handle.advertise<std_msgs::Bool>("out", 1);
  if (size > argc) // TPC größe
    publisher.publish(std_msgs::Bool());
}
