// A recursive function publishes; parameters bound its depth and how near it
// has to come.
#include <cmath>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Bisector {
public:
  Bisector() {
    ros::NodeHandle pnh("~");
    max_depth_ = pnh.param<int>("max_depth", 4);
    pnh.param<double>("tolerance", tolerance_, 1.0);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Bisector::onTarget, this);
  }

private:
  void onTarget(const std_msgs::Float64::ConstPtr &msg) {
    split(-10.0, 10.0, msg->data, 0);
  }

  void split(double low, double high, double target, int depth) {
    if (depth >= max_depth_)
      return;
    const double middle = (low + high) / 2.0;
    std_msgs::Float64 out;
    out.data = middle;
    pub_.publish(out);
    if (std::fabs(target - middle) < tolerance_)
      return;
    if (target < middle)
      split(low, middle, target, depth + 1);
    else
      split(middle, high, target, depth + 1);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  int max_depth_;
  double tolerance_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_recursion");
  Bisector bisector;
  ros::spin();
  return 0;
}
