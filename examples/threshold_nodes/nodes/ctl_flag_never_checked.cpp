// Negative twin of ctl_flag_then_check: the flags are set by comparisons, but
// nothing that is published looks at them.
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>

class TemperatureGuard {
public:
  explicit TemperatureGuard(ros::NodeHandle &nh) {
    nh.param<double>("max_temperature", m_max_temperature, 5.0);
    nh.param<double>("min_temperature", m_min_temperature, -5.0);
    m_pub = nh.advertise<std_msgs::Bool>("output", 1000);
    m_sub = nh.subscribe("input", 1000, &TemperatureGuard::temperatureCb, this);
  }

private:
  void temperatureCb(const std_msgs::Float64 &temperature) {
    bool too_hot = false;
    if (temperature.data > m_max_temperature)
      too_hot = true;
    const bool too_cold = temperature.data < m_min_temperature;

    if (too_hot)
      ROS_WARN("too hot");
    if (too_cold)
      m_was_cold = true;

    std_msgs::Bool heating;
    heating.data = temperature.data < 0.0;
    m_pub.publish(heating);
  }

  ros::Publisher m_pub;
  ros::Subscriber m_sub;
  double m_max_temperature;
  double m_min_temperature;
  bool m_was_cold = false;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_flag_never_checked");
  ros::NodeHandle nh;
  TemperatureGuard guard(nh);
  ros::spin();
  return 0;
}
