// A std::atomic is raised by a threshold in the callback and read by a thread,
// which publishes; globals and a free thread function.
#include <atomic>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>
#include <thread>

static std::atomic<int> g_detections{0};
static double g_detect_above = 2.0;
static int g_group = 3;

static void detectorCallback(const std_msgs::Float64::ConstPtr &msg) {
  if (msg->data > g_detect_above)
    ++g_detections;
}

static void announce(ros::Publisher pub) {
  int announced = 0;
  while (ros::ok()) {
    while (g_detections - announced >= g_group) {
      announced += g_group;
      std_msgs::Int32 msg;
      msg.data = announced;
      pub.publish(msg);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_atomic_count");
  ros::NodeHandle nh;
  nh.getParam("detect_above", g_detect_above);
  nh.getParam("group", g_group);
  ros::Publisher pub = nh.advertise<std_msgs::Int32>("output", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, detectorCallback);
  std::thread announcer(announce, pub);
  ros::spin();
  announcer.join();
  return 0;
}
