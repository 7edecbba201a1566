// Booleans: plain flags, negated flags, bool against bool, flags in a struct
// with bit fields, a while on a flag.
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>

class Switches {
public:
  Switches() : pnh_("~") {
    pnh_.param("active", active_, true);
    pnh_.param("mute_low", mute_low_, false);
    pnh_.param("expect_high", expect_high_, true);
    pnh_.param("squared", squared_, true);
    pnh_.param("drain", drain_, false);
    options_.echo = pnh_.param("echo", true);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    state_pub_ = nh_.advertise<std_msgs::Bool>("state", 1000);
    sub_ = nh_.subscribe("input", 1000, &Switches::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    if (!active_)
      return;
    const bool high = msg->data > 1.0;
    if (high == expect_high_) {
      std_msgs::Bool state;
      state.data = high;
      state_pub_.publish(state);
    }
    if (!high && mute_low_)
      return;
    std_msgs::Float64 out;
    out.data = squared_ ? msg->data * msg->data : msg->data;
    if (options_.echo)
      pub_.publish(out);
    int left = 3;
    while (drain_) {
      pub_.publish(out);
      if (--left == 0)
        break;
    }
  }

  ros::NodeHandle nh_, pnh_;
  ros::Publisher pub_, state_pub_;
  ros::Subscriber sub_;
  struct {
    unsigned echo : 1;
    unsigned spare : 7;
  } options_ = {};
  bool active_, mute_low_, expect_high_, squared_, drain_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "cmp_bool");
  Switches switches;
  ros::spin();
}
