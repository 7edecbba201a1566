// Thresholds and values of type float, and a float against a double.
#include <ros/ros.h>
#include <std_msgs/Float32.h>
#include <std_msgs/Float64.h>

static float s_gain_limit;
static float s_offset_limit;
static double s_mixed_limit;

int main(int argc, char **argv) {
  ros::init(argc, argv, "cmp_float");
  ros::NodeHandle nh;
  nh.param<float>("gain_limit", s_gain_limit, 3.3f);
  s_offset_limit = nh.param<float>("offset_limit", -3.3f);
  ros::param::param("mixed_limit", s_mixed_limit, 0.1);

  ros::Publisher pub = nh.advertise<std_msgs::Float32>("output", 1000);
  ros::Subscriber sub = nh.subscribe<std_msgs::Float64>(
      "input", 1000, [&](const std_msgs::Float64::ConstPtr &msg) {
        const float value = static_cast<float>(msg->data);
        std_msgs::Float32 out;
        out.data = value;
        if (value > s_gain_limit)
          out.data = s_gain_limit;
        if (msg->data < s_offset_limit)
          out.data = -1.0f;
        if (value / 10.0f >= s_mixed_limit)
          pub.publish(out);
        else if (value < 0.0f)
          pub.publish(out);
      });
  ros::spin();
  return 0;
}
