// A parameter that is a set of bits, each tested by itself.
#include <cstdint>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>

namespace {

enum Option : std::uint32_t {
  kPublishRaw = 1u << 0,
  kRectify = 1u << 1,
  kCount = 1u << 2,
  kQuiet = 1u << 3,
};

std::uint32_t g_options = 0;
int g_channels = 0;
ros::Publisher g_raw_pub, g_count_pub;

void onInput(const std_msgs::Float64::ConstPtr &msg) {
  static int count = 0;
  std_msgs::Float64 out = *msg;
  if ((g_options & kRectify) != 0 && out.data < 0)
    out.data = -out.data;
  if (g_options & kPublishRaw)
    g_raw_pub.publish(out);
  if (!(g_options & kQuiet))
    ROS_DEBUG("%g", msg->data);
  if (g_options & kCount) {
    std_msgs::Int32 message;
    message.data = ++count;
    for (int i = 0; i < 3; ++i)
      if (g_channels & 4)
        g_count_pub.publish(message);
  }
}

} // namespace

int main(int argc, char **argv) {
  ros::init(argc, argv, "cmp_bits");
  ros::NodeHandle nh;
  int options = kPublishRaw | kRectify | kCount;
  nh.param("options", options, options);
  g_options = static_cast<std::uint32_t>(options);
  nh.param("channels", g_channels, 5);
  g_raw_pub = nh.advertise<std_msgs::Float64>("output", 1000);
  g_count_pub = nh.advertise<std_msgs::Int32>("count", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, onInput);
  ros::spin();
  return 0;
}
