// The twin of val_min_max_clamp: the limited values are logged, or thrown
// away, and the raw value is published.
#include <algorithm>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

static double ceiling = 6.0;
static double lowest = -6.0;
static double band = 1.0;
static ros::Publisher pub;

static void onInput(const std_msgs::Float64::ConstPtr &msg) {
  const double limited = std::min(msg->data, ceiling);
  ROS_DEBUG("limited to %g", limited);
  std_msgs::Float64 out;
  out.data = std::clamp(msg->data, lowest, ceiling);
  out.data = msg->data;
  double near = 0.0;
  near += std::max(std::fabs(msg->data), band);
  pub.publish(out);
  ROS_INFO_THROTTLE(5, "near %g", near);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_min_max_cut");
  ros::NodeHandle nh;
  nh.getParam("ceiling", ceiling);
  nh.getParam("lowest", lowest);
  nh.getParam("band", band);
  pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, onInput);
  ros::spin();
  return 0;
}
