// Timeouts: compared as seconds, and inside the operators of ros::Duration.
// The stamps are made from the input.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Watchdog {
public:
  explicit Watchdog(ros::NodeHandle nh) : last_(100.0) {
    nh.param("timeout", timeout_, 8.0);
    nh.param("minutes", minutes_, 0.05);
    nh.param("grace", grace_, 5.0);
    max_age_ = ros::Duration(nh.param("max_age", 2.0));
    pub_ = nh.advertise<std_msgs::Float64>("output", 1000);
    late_pub_ = nh.advertise<std_msgs::Float64>("late", 1000);
    sub_ = nh.subscribe("input", 1000, &Watchdog::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    const ros::Time stamp(100.0 + msg->data);
    const ros::Duration age = stamp - last_;
    last_ = stamp;
    if ((stamp - ros::Time(95.0)).toSec() > timeout_)
      return;
    if (age.toSec() < -60 * minutes_)
      return;
    if (age > ros::Duration(grace_))
      late_pub_.publish(msg);
    if (max_age_ < age)
      return;
    pub_.publish(msg);
  }

  ros::Publisher pub_, late_pub_;
  ros::Subscriber sub_;
  ros::Time last_;
  ros::Duration max_age_;
  double timeout_, minutes_, grace_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "drv_duration");
  ros::Time::init();
  Watchdog watchdog{ros::NodeHandle()};
  ros::spin();
  return 0;
}
