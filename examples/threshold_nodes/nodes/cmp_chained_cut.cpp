// The twin of cmp_chained: the same conditions, but they guard counters, the
// log, and state that is overwritten.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class LanderLog {
public:
  LanderLog() {
    nh_.param("max_speed", max_speed_, 6.0);
    nh_.param("min_height", min_height_, -6.0);
    nh_.param("settle", settle_, 2);
    nh_.param("tilt", tilt_, 4.0);
    nh_.param("override", override_, false);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &LanderLog::callback, this);
  }

private:
  void callback(const std_msgs::Float64ConstPtr &msg) {
    const double v = msg->data;
    if (v < max_speed_ && v > min_height_ && ++samples_ >= settle_)
      ROS_INFO_ONCE("settled at %g", v);
    std_msgs::Float64 out;
    out.data = v;
    if (std::fabs(v - last_) > tilt_ || override_)
      out.data = 0.0;
    last_ = v;
    out.data = v / 2;
    pub_.publish(out);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double max_speed_, min_height_, tilt_;
  int settle_;
  bool override_;
  double last_ = 0.0;
  int samples_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "cmp_chained_cut");
  LanderLog lander;
  ros::spin();
  return 0;
}
