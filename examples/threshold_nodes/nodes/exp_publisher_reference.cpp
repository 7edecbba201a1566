// The publisher is passed by reference to a free function, and the threshold
// with it.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

namespace {

bool publishAbove(const ros::Publisher &publisher, double value,
                  const double &threshold) {
  if (value <= threshold)
    return false;
  std_msgs::Float64 msg;
  msg.data = value;
  publisher.publish(msg);
  return true;
}

class TwoLevels {
public:
  TwoLevels()
      : low_(nh_.param<double>("low_level", 1.0)),
        high_(nh_.param<double>("high_level", 6.0)),
        low_pub_(nh_.advertise<std_msgs::Float64>("low", 1000)),
        high_pub_(nh_.advertise<std_msgs::Float64>("high", 1000)),
        sub_(nh_.subscribe("input", 1000, &TwoLevels::input, this)) {}

private:
  void input(const std_msgs::Float64 &msg) {
    if (!publishAbove(high_pub_, msg.data, high_))
      publishAbove(low_pub_, msg.data, low_);
  }

  ros::NodeHandle nh_;
  double low_;
  double high_;
  ros::Publisher low_pub_;
  ros::Publisher high_pub_;
  ros::Subscriber sub_;
};

} // namespace

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_publisher_reference");
  TwoLevels node;
  ros::spin();
  return 0;
}
