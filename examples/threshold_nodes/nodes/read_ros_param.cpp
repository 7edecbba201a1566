// The free functions ros::param::get and ros::param::param, with private names.
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>

struct Alarm {
  double high = 5.0;
  double low;
  double reset;
  bool latched = false;
  bool repeat;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "read_ros_param");
  ros::NodeHandle nh;

  Alarm alarm;
  if (!ros::param::get("~high_alarm", alarm.high))
    ROS_INFO("high_alarm is not set, %g is used", alarm.high);
  ros::param::param<double>("~low_alarm", alarm.low, -5.0);
  ros::param::param("reset_level", alarm.reset, 1.0);
  alarm.repeat = ros::param::param<bool>("/repeat_alarm", false);

  ros::Publisher pub = nh.advertise<std_msgs::Bool>("output", 1000);
  auto onInput = [&](const std_msgs::Float64::ConstPtr &msg) {
    const bool before = alarm.latched;
    if (msg->data > alarm.high || msg->data < alarm.low)
      alarm.latched = true;
    else if (std::fabs(msg->data) < alarm.reset)
      alarm.latched = false;

    if (alarm.latched != before || alarm.repeat) {
      std_msgs::Bool out;
      out.data = alarm.latched;
      pub.publish(out);
    }
  };
  ros::Subscriber sub = nh.subscribe<std_msgs::Float64>("input", 1000, onInput);
  ros::spin();
  return 0;
}
