// Several ifs, nested and in a row, some with a threshold and some without.
#include <cmath>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>

namespace {

struct Limits {
  double lower = -6.0;
  double upper = 6.0;
  double alarm = -8.0;
  bool verbose = false;
};

Limits limits;
ros::Publisher in_band_pub;
ros::Publisher parity_pub;
int alarms = 0;

void inputCallback(const std_msgs::Float64::ConstPtr &in) {
  if (!std::isnan(in->data)) {
    if (in->data > limits.lower) {
      if (in->data < limits.upper) {
        in_band_pub.publish(*in);
      } else if (limits.verbose) {
        ROS_INFO("%f is above the band", in->data);
      }
    }
  }

  if (in->data < limits.alarm)
    ++alarms;
  ROS_DEBUG("alarms: %d", alarms);

  const int rounded = static_cast<int>(in->data);
  if (rounded % 2 == 0) {
    std_msgs::Int32 parity;
    parity.data = rounded;
    parity_pub.publish(parity);
  }
}

} // namespace

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_nested_ifs");
  ros::NodeHandle nh;
  nh.getParam("lower_limit", limits.lower);
  nh.getParam("upper_limit", limits.upper);
  nh.getParam("alarm_limit", limits.alarm);
  nh.getParam("verbose", limits.verbose);
  in_band_pub = nh.advertise<std_msgs::Float64>("in_band", 1000);
  parity_pub = nh.advertise<std_msgs::Int32>("parity", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, inputCallback);
  ros::spin();
}
