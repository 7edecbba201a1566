// Negative twin of ctl_switch_parameter: the switch on the parameter chooses
// what is logged and nothing else.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class VerboseRelay {
public:
  VerboseRelay() : pnh_("~") {
    pnh_.param("verbosity", verbosity_, 1);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &VerboseRelay::callback, this);
  }

private:
  void callback(const std_msgs::Float64::ConstPtr &msg) {
    switch (verbosity_) {
    case 0:
      break;
    case 1:
      ROS_DEBUG("got a value");
      break;
    case 2:
      ROS_INFO("got a value");
      break;
    default:
      ROS_INFO("got a value: %f", msg->data);
      ++detailed_;
    }
    pub_.publish(msg);
  }

  ros::NodeHandle nh_;
  ros::NodeHandle pnh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  int verbosity_;
  int detailed_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_switch_log_only");
  VerboseRelay node;
  ros::spin();
  return 0;
}
