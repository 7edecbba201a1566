// Throttles: every n-th value is published, and not more than a maximum in all.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Throttle {
  ros::NodeHandle nh;
  ros::Publisher pub;
  ros::Subscriber sub;
  int every_nth;
  int max_messages;
  int skipped = 0;
  int published = 0;

  void onMessage(const std_msgs::Float64::ConstPtr &msg) {
    if (published == max_messages)
      return;
    if (++skipped < every_nth)
      return;
    skipped = 0;
    ++published;
    pub.publish(msg);
  }

public:
  Throttle() {
    every_nth = nh.param("throttle/every_nth", 3);
    max_messages = nh.param("throttle/max_messages", 12);
    pub = nh.advertise<std_msgs::Float64>("output", 1000);
    sub = nh.subscribe("input", 1000, &Throttle::onMessage, this);
  }
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_throttle_count");
  Throttle throttle;
  ros::spin();
  return 0;
}
