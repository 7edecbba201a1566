// Constants from a header: constexpr, a macro, static const, an enumerator,
// a static member.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/UInt8.h>
#include <threshold_nodes/robot_limits.h>

namespace limits = threshold_nodes::limits;

class Supervisor {
public:
  explicit Supervisor(ros::NodeHandle nh) {
    status_pub_ = nh.advertise<std_msgs::UInt8>("status", 1000);
    pub_ = nh.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh.subscribe("input", 1000, &Supervisor::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    std_msgs::UInt8 status;
    if (msg->data > limits::kMaxSpeed)
      status.data |= 1;
    if (msg->data < ROBOT_MIN_SPEED)
      status.data |= 2;
    if (std::fabs(msg->data - last_) > limits::max_jump)
      status.data |= 4;
    last_ = msg->data;
    status_pub_.publish(status);
    if (++count_ < limits::MIN_SAMPLES)
      return;
    if (msg->data >= limits::Battery::kLow)
      pub_.publish(msg);
  }

  ros::Publisher status_pub_, pub_;
  ros::Subscriber sub_;
  double last_ = 0.0;
  int count_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "const_header");
  Supervisor supervisor{ros::NodeHandle()};
  ros::spin();
  return 0;
}
