// Hysteresis: two thresholds switch a member on and off, the member decides
// whether is published.
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>

class Heater {
public:
  Heater() {
    ros::NodeHandle nh;
    nh.param("heater/off_above", m_off_above, 4.0);
    nh.param("heater/on_below", m_on_below, -1.0);
    m_pub = nh.advertise<std_msgs::Bool>("output", 1000);
    m_sub = nh.subscribe("input", 1000, &Heater::control, this);
  }

  void control(const std_msgs::Float64::ConstPtr &temperature) {
    if (m_heating) {
      if (temperature->data > m_off_above)
        m_heating = false;
    } else {
      if (temperature->data < m_on_below)
        m_heating = true;
    }

    if (m_heating) {
      std_msgs::Bool on;
      on.data = true;
      m_pub.publish(on);
    }
  }

private:
  ros::Publisher m_pub;
  ros::Subscriber m_sub;
  double m_off_above;
  double m_on_below;
  bool m_heating = false;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_hysteresis");
  Heater heater;
  ros::spin();
  return 0;
}
