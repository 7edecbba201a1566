// Conditions of several operands: each operand of && and || that compares a
// parameter counts, between others that are none.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/String.h>

class Conditions {
public:
  Conditions() {
    nh_.param("enabled", enabled_, true);
    nh_.param("low", low_, -2.0);
    nh_.param("high", high_, 4.0);
    nh_.param("alarm", alarm_, 8.0);
    nh_.param("force", force_, false);
    nh_.param("even_limit", even_limit_, 0.0);
    nh_.param("mute", mute_, true);
    and_pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    or_pub_ = nh_.advertise<std_msgs::Float64>("either", 1000);
    mixed_pub_ = nh_.advertise<std_msgs::Float64>("mixed", 1000);
    sub_ = nh_.subscribe("input", 1000, &Conditions::input, this);
  }

private:
  void input(const std_msgs::Float64::ConstPtr &msg) {
    const double v = msg->data;
    ++count_;
    if (enabled_ && v > low_ && v < high_)
      and_pub_.publish(msg);
    if (v < -9.0 || v > alarm_ || force_)
      or_pub_.publish(msg);
    if ((v > even_limit_ && count_ % 2 == 0) || !mute_)
      mixed_pub_.publish(msg);
  }

  ros::NodeHandle nh_;
  ros::Publisher and_pub_, or_pub_, mixed_pub_;
  ros::Subscriber sub_;
  bool enabled_, force_, mute_;
  double low_, high_, alarm_, even_limit_;
  unsigned count_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_short_circuit");
  Conditions conditions;
  ros::spin();
  return 0;
}
