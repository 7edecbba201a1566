#include <ros/ros.h>
#include <std_msgs/Empty.h>

int main(int argc, char **argv) {
  ros::init(argc, argv, "by_macro");
  ros::NodeHandle handle("~");
  const bool enabled = handle.param("enabled", true);
  ros::Publisher publisher = handle.advertise<std_msgs::Empty>("out", 1);
  if (enabled) // TPC ~enabled
    publisher.publish(std_msgs::Empty());
}
