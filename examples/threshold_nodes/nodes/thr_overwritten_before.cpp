// Negative: parameters are read into variables that are overwritten before
// they are compared.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

static ros::Publisher pub;

static double readLimit(ros::NodeHandle &nh) {
  double limit = 0.0;
  nh.getParam("limit", limit);
  ROS_INFO("configured limit %f, this version uses its own", limit);
  limit = 4.0;
  return limit;
}

static double limit;

static void inputCallback(const std_msgs::Float64::ConstPtr &msg) {
  int tolerance = ros::param::param("~tolerance", 2);
  ROS_DEBUG("tolerance %d", tolerance);
  tolerance = static_cast<int>(msg->data) % 3;
  if (msg->data > limit)
    pub.publish(msg);
  else if (msg->data < tolerance)
    pub.publish(msg);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_overwritten_before");
  ros::NodeHandle nh;
  limit = readLimit(nh);
  pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, inputCallback);
  ros::spin();
  return 0;
}
