// Predicates that only guard the log, written as ifs and as logging macros.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Verbose {
public:
  explicit Verbose(const ros::NodeHandle &nh) : nh_(nh) {
    nh_.param("warn_level", warn_level_, 6.0);
    nh_.param("info_level", info_level_, 3.0);
    nh_.param("error_level", error_level_, 9.0);
    nh_.param("trace", trace_, false);
    nh_.param("summary_every", summary_every_, 50);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Verbose::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    ROS_INFO_COND(msg->data > info_level_, "high: %g", msg->data);
    ROS_WARN_STREAM_COND(msg->data > warn_level_, "very high: " << msg->data);
    if (msg->data > error_level_)
      ROS_ERROR_THROTTLE(1, "far too high: %g", msg->data);
    if (trace_)
      trace(msg->data);
    if (++count_ == summary_every_) {
      ROS_INFO_STREAM(count_ << " messages");
      count_ = 0;
    }
    pub_.publish(msg);
  }

  void trace(double value) const {
    ROS_DEBUG_COND(value < -warn_level_, "very low: %g", value);
    ROS_DEBUG("value %g", value);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double warn_level_, info_level_, error_level_;
  bool trace_;
  int summary_every_;
  int count_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_logging");
  ros::NodeHandle nh;
  Verbose verbose(nh);
  ros::spin();
  return 0;
}
