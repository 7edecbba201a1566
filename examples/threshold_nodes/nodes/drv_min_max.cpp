// Parameters limited by constants before they are compared.
#include <algorithm>
#include <cmath>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Robust {
public:
  Robust() {
    double high, low, window, depth;
    nh_.param("high", high, 20.0);
    nh_.param("low", low, -20.0);
    nh_.param("window", window, 0.1);
    nh_.param("depth", depth, 3.0);
    high_ = std::min(high, 8.0);
    low_ = std::max(-8.0, low);
    window_ = std::fmax(window, 1.0);
    depth_ = std::abs(depth);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Robust::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    std_msgs::Float64 out;
    out.data = msg->data;
    if (out.data > high_)
      return;
    if (out.data < low_)
      return;
    if (std::fabs(out.data) < window_)
      out.data = 0.0;
    if (out.data < -depth_)
      out.data = -10.0;
    pub_.publish(out);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double high_, low_, window_, depth_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "drv_min_max");
  Robust robust;
  ros::spin();
  return 0;
}
