// A template helper that returns the value reads parameters of several types.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <string>

template <typename T>
T setting(const ros::NodeHandle &nh, const std::string &name, T fallback) {
  T value = fallback;
  nh.getParam(name, value);
  return value;
}

class Decimator {
public:
  Decimator() {
    enabled_ = setting(nh_, "enabled", true);
    threshold_ = setting(nh_, "threshold", 1.0);
    every_ = setting(nh_, "every", 3);
    mode_ = setting<std::string>(nh_, "mode", "signed");
    tolerance_ = setting<float>(nh_, "tolerance", 0.5f);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Decimator::input, this);
  }

private:
  void input(const std_msgs::Float64::ConstPtr &msg) {
    if (!enabled_)
      return;
    double value = msg->data;
    if (mode_ == "absolute")
      value = std::fabs(value);
    if (value < threshold_)
      return;
    if (std::fabs(value - previous_) < tolerance_)
      return;
    previous_ = value;
    if (++count_ < every_)
      return;
    count_ = 0;
    std_msgs::Float64 out;
    out.data = value;
    pub_.publish(out);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  bool enabled_;
  double threshold_;
  int every_;
  std::string mode_;
  float tolerance_;
  double previous_ = 0.0;
  int count_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "read_template_helper");
  Decimator decimator;
  ros::spin();
  return 0;
}
