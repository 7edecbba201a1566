// Enumerations read as integers: compared, switched on, and cast first.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

enum Level { LOW, MEDIUM, HIGH };
enum class Mode : int { Off = 0, Follow = 1, Invert = 2 };

struct Config {
  Mode mode = Mode::Off;
  Level min_level = LOW;
  int shape = 0;
};

static Level classify(double value) {
  if (value > 4.0)
    return HIGH;
  return value > 0.0 ? MEDIUM : LOW;
}

static double shaped(const Config &config, double value) {
  switch (config.shape) {
  case 1:
    return value * value;
  case 2:
    return value * value * value;
  default:
    return value;
  }
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "cmp_enum");
  ros::NodeHandle nh, pnh("~");
  Config config;
  int value = 0;
  pnh.param("mode", value, 2);
  config.mode = static_cast<Mode>(value);
  config.min_level = static_cast<Level>(pnh.param<int>("min_level", MEDIUM));
  pnh.param("shape", config.shape, 1);

  ros::Publisher pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe<std_msgs::Float64>(
      "input", 1000, [&](const std_msgs::Float64::ConstPtr &msg) {
        if (config.mode == Mode::Off)
          return;
        std_msgs::Float64 out;
        out.data = shaped(config, msg->data);
        if (Mode::Invert == config.mode)
          out.data = -out.data;
        if (classify(msg->data) >= config.min_level)
          pub.publish(out);
      });
  ros::spin();
  return 0;
}
