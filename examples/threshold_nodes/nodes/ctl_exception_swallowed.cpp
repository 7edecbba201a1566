// Negative twin of ctl_exception: the guarded throw is caught at once and only
// counted, the publish follows in any case.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <stdexcept>

class CheckedRelay {
public:
  CheckedRelay() {
    nh_.param("ceiling", ceiling_, 6.0);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &CheckedRelay::relay, this);
  }

private:
  void relay(const std_msgs::Float64::ConstPtr &msg) {
    try {
      if (msg->data > ceiling_)
        throw std::out_of_range("above the ceiling");
      ++good_;
    } catch (const std::out_of_range &e) {
      ROS_INFO("%s after %lu good values", e.what(), good_);
    }
    pub_.publish(msg);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double ceiling_;
  unsigned long good_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_exception_swallowed");
  CheckedRelay relay;
  ros::spin();
  return 0;
}
