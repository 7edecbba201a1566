// The plainest case: a publish directly inside the if that compares the value
// with a parameter.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class OverLimit {
public:
  OverLimit() {
    nh_.param("limit", limit_, 4.0);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &OverLimit::onValue, this);
  }

private:
  void onValue(const std_msgs::Float64::ConstPtr &msg) {
    const double value = msg->data;
    if (value > limit_) {
      std_msgs::Float64 out;
      out.data = value - 1.0;
      pub_.publish(out);
    }
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double limit_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_direct_if");
  OverLimit node;
  ros::spin();
  return 0;
}
