// Comparisons in a header of the package: a function template, an inline
// function and a class, each used for several parameters.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <threshold_nodes/range_tools.h>

class Mixer {
public:
  Mixer() : ramp_(nh_.param("ramp", 3.0)) {
    nh_.param("trim", trim_, 2);
    nh_.param("left_cap", left_cap_, 4.0);
    nh_.param("right_cap", right_cap_, 6.0);
    nh_.param("log_cap", log_cap_, 5.0);
    left_pub_ = nh_.advertise<std_msgs::Float64>("left", 1000);
    right_pub_ = nh_.advertise<std_msgs::Float64>("right", 1000);
    sub_ = nh_.subscribe("input", 1000, &Mixer::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64 &msg) {
    std_msgs::Float64 out;
    out.data = threshold_nodes::saturate(msg.data, left_cap_);
    left_pub_.publish(out);

    out.data = threshold_nodes::saturate(-msg.data, right_cap_);
    out.data = ramp_.limit(out.data);
    if (threshold_nodes::exceeds(++n_, trim_)) {
      n_ = 0;
      right_pub_.publish(out);
    }
    if (threshold_nodes::exceeds(msg.data, log_cap_))
      ROS_INFO("over the cap");
  }

  ros::NodeHandle nh_;
  threshold_nodes::Ramp ramp_;
  int trim_;
  int n_ = 0;
  double left_cap_, right_cap_, log_cap_;
  ros::Publisher left_pub_, right_pub_;
  ros::Subscriber sub_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_header_code");
  Mixer mixer;
  ros::spin();
  return 0;
}
