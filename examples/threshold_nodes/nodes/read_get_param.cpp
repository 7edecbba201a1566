// NodeHandle::getParam, with the default assigned before the read, after a
// failed read, and behind hasParam.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

namespace {

class Limiter {
public:
  bool init(ros::NodeHandle &nh) {
    m_lower = -5.0;
    nh.getParam("lower_limit", m_lower);
    if (!nh.getParam("upper_limit", m_upper))
      m_upper = 5.0;
    if (nh.hasParam("dead_zone"))
      nh.getParam("dead_zone", m_deadZone);
    if (!nh.getParam("stride", m_stride)) {
      ROS_WARN("no stride is set, every message counts");
      m_stride = 2;
    }
    m_pub = nh.advertise<std_msgs::Float64>("output", 1000);
    m_sub = nh.subscribe("input", 1000, &Limiter::callback, this);
    return true;
  }

private:
  void callback(const std_msgs::Float64ConstPtr &msg) {
    std_msgs::Float64 out;
    out.data = msg->data;
    if (out.data > m_upper)
      out.data = m_upper;
    else if (m_lower > out.data)
      out.data = m_lower;
    if (std::abs(out.data) < m_deadZone)
      out.data = 0.0;
    if (++m_seen >= m_stride) {
      m_seen = 0;
      m_pub.publish(out);
    }
  }

  ros::Publisher m_pub;
  ros::Subscriber m_sub;
  double m_lower = 0.0;
  double m_upper = 0.0;
  double m_deadZone = 1.5;
  int m_stride = 1;
  int m_seen = 0;
};

} // namespace

int main(int argc, char **argv) {
  ros::init(argc, argv, "read_get_param");
  ros::NodeHandle nh;
  Limiter limiter;
  if (!limiter.init(nh))
    return 1;
  ros::spin();
  return 0;
}
