// do-while: the condition behind the publish compares with a parameter and
// decides whether it is published once more.
#include <cmath>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Halver {
public:
  Halver() : nh_(), floor_(nh_.param<double>("halving/floor", 0.75)) {
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Halver::halve, this);
  }

private:
  void halve(const std_msgs::Float64ConstPtr &msg) {
    double rest = std::fabs(msg->data);
    do {
      std_msgs::Float64 out;
      out.data = rest;
      pub_.publish(out);
      rest /= 2.0;
    } while (rest > floor_);
  }

  ros::NodeHandle nh_;
  double floor_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_do_while");
  Halver halver;
  ros::spin();
  return 0;
}
