// Negative twin of thr_setter_argument: the functions that get the parameter
// do not store it, so that the comparisons are with other values.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Limiter {
public:
  void setLimit(double limit) { ROS_DEBUG("limit %f ignored", limit); }
  bool passes(double value) const { return !(value > limit_); }

private:
  double limit_ = 7.0;
};

class Node {
public:
  Node() {
    double max_value = 0.0;
    nh_.param("max_value", max_value, 7.0);
    limiter_.setLimit(max_value);
    nh_.param("min_value", min_value_, -7.0);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Node::input, this);
  }

private:
  static bool tooLow(double value, double /*minimum*/) { return value < -7.0; }

  void input(const std_msgs::Float64::ConstPtr &msg) {
    if (!tooLow(msg->data, min_value_) && limiter_.passes(msg->data))
      pub_.publish(msg);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  Limiter limiter_;
  double min_value_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_argument_not_stored");
  Node node;
  ros::spin();
  return 0;
}
