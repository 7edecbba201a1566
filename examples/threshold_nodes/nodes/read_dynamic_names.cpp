// Names that are known in part or not at all before the node runs.
#include <array>
#include <ros/ros.h>
#include <sstream>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>
#include <string>

class WheelMonitor {
public:
  explicit WheelMonitor(const ros::NodeHandle &nh) : nh_(nh) {
    for (int i = 0; i < 2; ++i)
      nh_.param("wheel_" + std::to_string(i) + "/limit", wheel_limit_[i],
                3.0 + i);
    const char *names[] = {"rate_limit", "skip_limit"};
    double *targets[] = {&rate_limit_, &skip_limit_};
    for (int i = 0; i < 2; ++i)
      nh_.param(names[i], *targets[i], 5.0 + 2 * i);

    std::ostringstream key;
    key << "axle_" << ros::this_node::getName().size() << "_slip";
    nh_.param(key.str(), slip_, -6.0);

    pub_ = nh_.advertise<std_msgs::Int32>("output", 1000);
    raw_pub_ = nh_.advertise<std_msgs::Float64>("raw", 1000);
    sub_ = nh_.subscribe("input", 1000, &WheelMonitor::callback, this);
  }

private:
  void callback(const std_msgs::Float64 &msg) {
    std_msgs::Int32 over;
    for (double limit : wheel_limit_)
      if (msg.data > limit)
        ++over.data;
    pub_.publish(over);
    if (msg.data < slip_)
      raw_pub_.publish(msg);
    if (msg.data > rate_limit_)
      raw_pub_.publish(msg);
    if (msg.data > skip_limit_)
      raw_pub_.publish(msg);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_, raw_pub_;
  ros::Subscriber sub_;
  std::array<double, 2> wheel_limit_;
  double rate_limit_, skip_limit_, slip_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "read_dynamic_names");
  ros::NodeHandle nh;
  WheelMonitor monitor(nh);
  ros::spin();
  return 0;
}
