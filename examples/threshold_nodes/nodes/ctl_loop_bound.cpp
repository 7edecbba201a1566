// A parameter is the bound of the for loop that publishes; a second one, by a
// while, bounds how much goes into one message.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>

struct Repeater {
  ros::Publisher repeat_pub;
  ros::Publisher array_pub;
  int repetitions = 3;
  int array_size = 2;

  void operator()(const std_msgs::Float64 &msg) const {
    for (int i = 0; i < repetitions; ++i) {
      std_msgs::Float64 copy;
      copy.data = msg.data + i;
      repeat_pub.publish(copy);
    }

    std_msgs::Float64MultiArray array;
    int filled = 0;
    while (filled < array_size) {
      array.data.push_back(msg.data * filled);
      ++filled;
    }
    array_pub.publish(array);
  }
};

static Repeater repeater;

static void inputCallback(const std_msgs::Float64 &msg) { repeater(msg); }

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_loop_bound");
  ros::NodeHandle nh;
  nh.param("repetitions", repeater.repetitions, repeater.repetitions);
  nh.param("array_size", repeater.array_size, repeater.array_size);
  repeater.repeat_pub = nh.advertise<std_msgs::Float64>("output", 1000);
  repeater.array_pub = nh.advertise<std_msgs::Float64MultiArray>("array", 1000);
  ros::Subscriber sub =
      nh.subscribe<const std_msgs::Float64 &>("input", 1000, inputCallback);
  ros::spin();
}
