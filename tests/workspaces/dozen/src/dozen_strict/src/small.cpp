#include <ros/ros.h>
#include <std_msgs/Empty.h>

int main(int argc, char **argv) {
  ros::init(argc, argv, "small");
  ros::NodeHandle handle;
  ros::Publisher publisher = handle.advertise<std_msgs::Empty>("out", 1);
  if (argc > handle.param("arguments", 1)) // TPC arguments
    publisher.publish(std_msgs::Empty());
}
