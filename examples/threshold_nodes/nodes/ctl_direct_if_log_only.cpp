// Negative twin of ctl_direct_if: the branch only logs and counts, the publish
// comes after it in any case.
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
      ++exceeded_;
      ROS_INFO("value %f is over the limit (%d times now)", value, exceeded_);
    }
    std_msgs::Float64 out;
    out.data = value - 1.0;
    pub_.publish(out);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double limit_;
  int exceeded_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_direct_if_log_only");
  OverLimit node;
  ros::spin();
  return 0;
}
