// Limits applied with the functions of the standard library; the comparisons
// belong to the calls in this file.
#include <algorithm>
#include <cmath>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Saturation {
public:
  Saturation() : nh_("~") {
    nh_.param("ceiling", ceiling_, 6.0);
    nh_.param("floor", floor_, -6.0);
    nh_.param("left", left_, -2.0);
    nh_.param("right", right_, 2.0);
    nh_.param("band", band_, 1.0);
    ros::NodeHandle nh;
    pub_ = nh.advertise<std_msgs::Float64>("output", 1000);
    center_pub_ = nh.advertise<std_msgs::Float64>("center", 1000);
    sub_ = nh.subscribe("input", 1000, &Saturation::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    std_msgs::Float64 out;
    out.data = std::min(msg->data, ceiling_);
    out.data = std::max(floor_, out.data);
    pub_.publish(out);

    out.data = std::clamp(msg->data, left_, right_);
    if (std::abs(msg->data - out.data) < band_)
      center_pub_.publish(out);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_, center_pub_;
  ros::Subscriber sub_;
  double ceiling_, floor_, left_, right_, band_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_min_max_clamp");
  Saturation saturation;
  ros::spin();
}
