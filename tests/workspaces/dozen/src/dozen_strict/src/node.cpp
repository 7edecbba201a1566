#include <ros/ros.h>
#include <std_msgs/Int32.h>

extern "C" int doubled(int value);
extern "C" int one();

namespace {
class Unused {
  int field_ = 0;
};
} // namespace

int main(int argc, char **argv) {
  ros::init(argc, argv, "strict_node");
  ros::NodeHandle handle;
  Unused unused;
  static_cast<void>(unused);
  int most = 0;
  handle.param("most", most, 6);
  ros::Publisher publisher = handle.advertise<std_msgs::Int32>("out", 1);
  for (int i = 0; i < 8; ++i) {
    std_msgs::Int32 message;
    message.data = doubled(i) + one();
    if (message.data < most) // TPC most
      publisher.publish(message);
  }
}
