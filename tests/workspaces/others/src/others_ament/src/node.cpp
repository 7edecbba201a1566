#include <alarm.h>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

int main(int argc, char **argv) {
  ros::init(argc, argv, "ament_node");
  ros::NodeHandle handle;
  const double level = handle.param("level", 2.0);
  ros::Publisher publisher = handle.advertise<std_msgs::Float64>("out", 1);
  Alarm alarm(handle);
  for (int i = 0; i < 8; ++i) {
    alarm.heat(i);
    std_msgs::Float64 message;
    message.data = i;
    if (message.data > level) // TPC level
      publisher.publish(message);
  }
}
