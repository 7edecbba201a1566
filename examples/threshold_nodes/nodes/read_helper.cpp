// One helper reads all parameters: each comparison keeps the name that was
// handed to the helper.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <string>

namespace {

double max_accel = 0.0;
double max_brake = 0.0;
double jump = 0.0;
double unused_gain = 0.0;
double last = 0.0;
ros::Publisher pub;

void load(const ros::NodeHandle &nh, const std::string &name, double &value,
          double fallback) {
  if (!nh.getParam(name, value)) {
    ROS_DEBUG("%s: %g", name.c_str(), fallback);
    value = fallback;
  }
}

void onInput(const std_msgs::Float64 &msg) {
  const double change = msg.data - last;
  last = msg.data;
  std_msgs::Float64 out;
  out.data = change;
  if (change > max_accel)
    out.data = max_accel;
  if (-change > max_brake)
    out.data = -max_brake;
  if (std::fabs(change) > jump)
    pub.publish(out);
}

} // namespace

int main(int argc, char **argv) {
  ros::init(argc, argv, "read_helper");
  ros::NodeHandle nh;
  load(nh, "max_accel", max_accel, 4.0);
  load(nh, "max_brake", max_brake, 6.0);
  load(nh, "jump", jump, 2.0);
  load(nh, "unused_gain", unused_gain, 1.0);

  pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, onInput);
  ros::spin();
}
