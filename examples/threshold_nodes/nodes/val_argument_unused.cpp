// The twin of val_arguments_returns: arguments that are never used or stored,
// results that are dropped.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Filter {
public:
  Filter(double cutoff, int) : limit_(3.0) { checkRange(cutoff); }

  void setCutoff(double cutoff) {
    ROS_DEBUG("cutoff %g is ignored by this filter", cutoff);
  }

  void setWindow(double /* seconds */) { window_ = 2; }

  bool pass(double value) {
    if (++count_ < window_)
      return false;
    count_ = 0;
    return value < limit_;
  }

private:
  static bool checkRange(double cutoff) { return cutoff > 0.0; }

  double limit_;
  int window_ = 1;
  int count_ = 0;
};

static double effective(double requested, double available) {
  if (requested > available)
    requested = available;
  return available;
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_argument_unused");
  ros::NodeHandle nh;
  double cutoff = 5.0;
  nh.param("cutoff", cutoff, 5.0);
  Filter filter(cutoff, nh.param("order", 2));
  filter.setCutoff(cutoff);
  filter.setWindow(nh.param("window", 0.5));
  const double floor = effective(nh.param("floor", -5.0), -6.0);

  ros::Publisher pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe<std_msgs::Float64>(
      "input", 1000, [&](const std_msgs::Float64::ConstPtr &msg) {
        if (msg->data > floor && filter.pass(msg->data))
          pub.publish(msg);
      });
  ros::spin();
}
