// Debouncing: consecutive values over a threshold are counted, a parameter
// says how many make a press.
#include <ros/ros.h>
#include <std_msgs/Empty.h>
#include <std_msgs/Float64.h>

static double pressed_above = 0.5;
static int required_samples = 3;
static int streak;
static ros::Publisher pressed_pub;

void buttonCallback(const std_msgs::Float64ConstPtr &level) {
  if (level->data > pressed_above)
    ++streak;
  else
    streak = 0;

  if (streak == required_samples)
    pressed_pub.publish(std_msgs::Empty());
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_debounce");
  ros::NodeHandle nh;
  ros::param::get("~pressed_above", pressed_above);
  ros::param::get("~required_samples", required_samples);
  pressed_pub = nh.advertise<std_msgs::Empty>("output", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, buttonCallback);
  ros::spin();
  return 0;
}
