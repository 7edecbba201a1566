// A predicate decides a value that decides another predicate, three deep: a
// level, a rate from the level, and a loop over the rate.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/UInt8.h>

namespace {

struct Config {
  double warm;
  double hot;
  int alert_level;
} config;

ros::Publisher beep_pub;

int levelOf(double temperature) {
  int level = 0;
  if (temperature >= config.warm)
    level = 1;
  if (temperature >= config.hot)
    level = 2;
  return level;
}

void temperatureCallback(const std_msgs::Float64::ConstPtr &msg) {
  const int level = levelOf(msg->data);

  int beeps = 1;
  if (level >= config.alert_level)
    beeps = 3;

  for (int i = 0; i < beeps; ++i) {
    std_msgs::UInt8 beep;
    beep.data = static_cast<std::uint8_t>(i);
    beep_pub.publish(beep);
  }
}

} // namespace

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_decides_decides");
  ros::NodeHandle nh;
  config.warm = nh.param<double>("levels/warm", 0.0);
  config.hot = nh.param<double>("levels/hot", 5.0);
  config.alert_level = nh.param<int>("levels/alert", 2);
  beep_pub = nh.advertise<std_msgs::UInt8>("output", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, temperatureCallback);
  ros::spin();
  return 0;
}
