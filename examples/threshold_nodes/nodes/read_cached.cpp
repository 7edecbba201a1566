// getParamCached and ros::param::getCached, read again in each callback.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>

static ros::Publisher level_pub;
static ros::Publisher output_pub;

static void inputCallback(const std_msgs::Float64::ConstPtr &msg) {
  ros::NodeHandle nh;

  double threshold = 3.0;
  nh.getParamCached("threshold", threshold);
  if (msg->data >= threshold)
    output_pub.publish(*msg);

  double low_mark = -2.0;
  ros::param::getCached("low_mark", low_mark);
  std_msgs::Int32 level;
  level.data = 1;
  if (msg->data <= low_mark)
    level.data = 0;
  level_pub.publish(level);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "read_cached");
  ros::NodeHandle nh;
  output_pub = nh.advertise<std_msgs::Float64>("output", 1000);
  level_pub = nh.advertise<std_msgs::Int32>("level", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, inputCallback);
  ros::spin();
}
