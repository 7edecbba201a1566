// Negative twin of ctl_value_chosen: the chosen values are overwritten before
// the publish, a local variable and a field of the message.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

static ros::Publisher velocity_pub;
static double slow_distance;
static double turn_distance;

static void rangeCallback(const std_msgs::Float64::ConstPtr &range) {
  double speed;
  if (range->data < slow_distance) {
    speed = 0.25;
  } else {
    speed = 1.5;
  }
  ROS_DEBUG("speed would be %f", speed);
  speed = range->data * 0.5;

  std_msgs::Float64 velocity;
  velocity.data = range->data > turn_distance ? 1.0 : -1.0;
  ROS_DEBUG("direction would be %f", velocity.data);
  velocity.data = speed;
  velocity_pub.publish(velocity);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_value_overwritten");
  ros::NodeHandle nh;
  slow_distance = nh.param("slow_distance", 2.5);
  turn_distance = nh.param("turn_distance", -4.0);
  velocity_pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, rangeCallback);
  ros::spin();
  return 0;
}
