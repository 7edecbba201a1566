// A flag is set by a comparison and checked later in the same function, once
// stored by an if and once by an assignment.
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

    ++m_samples;

    if (too_hot) {
      std_msgs::Bool heating;
      heating.data = false;
      m_pub.publish(heating);
    }
    if (too_cold) {
      std_msgs::Bool heating;
      heating.data = true;
      m_pub.publish(heating);
    }
  }

  ros::Publisher m_pub;
  ros::Subscriber m_sub;
  double m_max_temperature;
  double m_min_temperature;
  unsigned m_samples = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_flag_then_check");
  ros::NodeHandle nh;
  TemperatureGuard guard(nh);
  ros::spin();
  return 0;
}
