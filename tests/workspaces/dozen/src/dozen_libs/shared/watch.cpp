#include <dozen_libs/watch.h>
#include <ros/ros.h>
#include <std_msgs/Empty.h>

void watch(double seconds) {
  static ros::NodeHandle handle;
  static ros::Publisher publisher = handle.advertise<std_msgs::Empty>("late", 1);
  double patience;
  ros::param::param("watch/patience", patience, 2.0);
  if (seconds > patience) // TPC watch/patience
    publisher.publish(std_msgs::Empty());
}
