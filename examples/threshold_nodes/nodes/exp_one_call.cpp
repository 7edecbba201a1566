// The publish stands one call behind the threshold.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Reporter {
public:
  explicit Reporter(ros::NodeHandle &nh)
      : pub_(nh.advertise<std_msgs::Float64>("output", 1000)) {}

  void report(double value) {
    std_msgs::Float64 msg;
    msg.data = value;
    pub_.publish(msg);
  }

private:
  ros::Publisher pub_;
};

class Monitor {
public:
  Monitor(ros::NodeHandle &nh, Reporter &reporter) : reporter_(reporter) {
    nh.param("monitor_limit", limit_, -2.5);
    sub_ = nh.subscribe("input", 1000, &Monitor::observe, this);
  }

private:
  void observe(const std_msgs::Float64::ConstPtr &msg) {
    if (limit_ > msg->data)
      reporter_.report(msg->data);
  }

  Reporter &reporter_;
  ros::Subscriber sub_;
  double limit_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_one_call");
  ros::NodeHandle nh;
  Reporter reporter(nh);
  Monitor monitor(nh, reporter);
  ros::spin();
  return 0;
}
