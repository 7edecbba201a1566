// Negative twin of ctl_short_circuit: the conditions with parameters in them
// guard only logging and counting; the one around the publish has none.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Conditions {
public:
  Conditions() {
    nh_.param("enabled", enabled_, true);
    nh_.param("low", low_, -2.0);
    nh_.param("alarm", alarm_, 8.0);
    nh_.param("quiet", quiet_, false);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Conditions::input, this);
  }

private:
  void input(const std_msgs::Float64::ConstPtr &msg) {
    const double v = msg->data;
    ++count_;
    if (enabled_ && v > low_)
      ++above_;
    if ((v < -9.0 || v > alarm_) && !quiet_)
      ROS_WARN("unusual value %f, %u above so far", v, above_);
    if (v > 0.0 && count_ % 2 == 0)
      pub_.publish(msg);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  bool enabled_, quiet_;
  double low_, alarm_;
  unsigned count_ = 0;
  unsigned above_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_short_circuit_log_only");
  Conditions conditions;
  ros::spin();
  return 0;
}
