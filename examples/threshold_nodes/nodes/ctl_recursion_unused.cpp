// Negative twin of ctl_recursion: the recursion that the parameter bounds only
// counts its steps for a debug line.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Bisector {
public:
  Bisector() {
    ros::NodeHandle pnh("~");
    max_depth_ = pnh.param<int>("max_depth", 4);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Bisector::onTarget, this);
  }

private:
  void onTarget(const std_msgs::Float64::ConstPtr &msg) {
    const int steps = split(-10.0, 10.0, msg->data, 0);
    ROS_DEBUG("%d steps", steps);
    pub_.publish(msg);
  }

  int split(double low, double high, double target, int depth) {
    if (depth >= max_depth_)
      return depth;
    const double middle = (low + high) / 2.0;
    return target < middle ? split(low, middle, target, depth + 1)
                           : split(middle, high, target, depth + 1);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  int max_depth_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_recursion_unused");
  Bisector bisector;
  ros::spin();
  return 0;
}
