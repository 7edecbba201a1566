// Negative: parameters are read and discarded, or only shown; the comparisons
// around the publish are with constants and inputs.
#include <cmath>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/String.h>

class Discarding {
public:
  Discarding() : pnh_("~") {
    double limit;
    pnh_.param("limit", limit, 4.0);
    int depth = 3;
    pnh_.getParam("depth", depth);
    (void)depth;
    pnh_.param("frame", frame_, std::string("map"));
    ROS_INFO_STREAM("limit " << limit << ", frame " << frame_);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    frame_pub_ = nh_.advertise<std_msgs::String>("frames", 1000);
    sub_ = nh_.subscribe("input", 1000, &Discarding::input, this);
  }

private:
  void input(const std_msgs::Float64::ConstPtr &msg) {
    const double limit = 4.0;
    if (msg->data > limit)
      pub_.publish(msg);
    if (std::fabs(msg->data) < std::fabs(last_)) {
      std_msgs::String frame;
      frame.data = frame_;
      frame_pub_.publish(frame);
    }
    last_ = msg->data;
  }

  ros::NodeHandle nh_, pnh_;
  ros::Publisher pub_, frame_pub_;
  ros::Subscriber sub_;
  std::string frame_;
  double last_ = 0.0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_read_discarded");
  Discarding node;
  ros::spin();
  return 0;
}
