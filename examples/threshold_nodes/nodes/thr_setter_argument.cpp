// The threshold is passed as an argument: to a setter of another object, and
// from hand to hand to the function that compares.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Limiter {
public:
  void setLimit(double limit) { limit_ = limit; }
  bool passes(double value) const { return !(value > limit_); }

private:
  double limit_ = 100.0;
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
  static bool tooLow(double value, double minimum) { return minimum > value; }

  bool usable(double value, double minimum) const {
    return !tooLow(value, minimum) && limiter_.passes(value);
  }

  void input(const std_msgs::Float64::ConstPtr &msg) {
    if (usable(msg->data, min_value_))
      pub_.publish(msg);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  Limiter limiter_;
  double min_value_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_setter_argument");
  Node node;
  ros::spin();
  return 0;
}
