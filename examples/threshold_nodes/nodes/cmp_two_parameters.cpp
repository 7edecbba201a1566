// Parameters compared with each other: a sanity check at the start, the choice
// of the wider limit, and in the callback.
#include <algorithm>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Window {
public:
  Window() {
    nh_.param("lower", lower_, -4.0);
    nh_.param("upper", upper_, 4.0);
    if (lower_ >= upper_) {
      ROS_ERROR("the window is empty, it is turned off");
      enabled_ = false;
    }
    double soft = nh_.param("soft", 1.0);
    double hard = nh_.param("hard", 3.0);
    widest_ = std::max(soft, hard);
    nh_.param("warmup", warmup_, 3);
    nh_.param("cooldown", cooldown_, 5);
    if (warmup_ > cooldown_)
      ROS_WARN("the warm-up is longer than the cool-down");
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Window::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64 &msg) {
    if (enabled_ && std::fabs(msg.data) > widest_)
      pub_.publish(msg);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double lower_, upper_, widest_;
  int warmup_, cooldown_;
  bool enabled_ = true;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "cmp_two_parameters");
  Window window;
  ros::spin();
  return 0;
}
