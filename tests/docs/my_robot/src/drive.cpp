#include <cmath>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

// Brakes whenever it is too fast, once a second.
int main(int argc, char **argv) {
  ros::init(argc, argv, "drive");
  ros::NodeHandle node("~");
  double maxSpeed;
  node.param("max_speed", maxSpeed, 0.8);
  ros::Publisher brake = node.advertise<std_msgs::Float64>("brake", 10);
  ros::Rate rate(20);
  while (ros::ok()) {
    std_msgs::Float64 speed;
    speed.data = std::fabs(std::sin(3.14 * ros::Time::now().toSec()));
    if (speed.data > maxSpeed)
      brake.publish(speed);
    ros::spinOnce();
    rate.sleep();
  }
}
