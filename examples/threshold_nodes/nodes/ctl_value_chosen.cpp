// The publish is unconditional; thresholds choose the value in it, by if/else
// and by the conditional operator.
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
  const double direction = range->data > turn_distance ? 1.0 : -1.0;

  std_msgs::Float64 velocity;
  velocity.data = speed * direction;
  velocity_pub.publish(velocity);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_value_chosen");
  ros::NodeHandle nh;
  slow_distance = nh.param("slow_distance", 2.5);
  turn_distance = nh.param("turn_distance", -4.0);
  velocity_pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, rangeCallback);
  ros::spin();
  return 0;
}
