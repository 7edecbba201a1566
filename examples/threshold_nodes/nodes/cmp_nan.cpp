// The input may be NaN: a comparison and the negation of its opposite differ.
#include <cmath>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/UInt8.h>

class NanSafe {
public:
  explicit NanSafe(ros::NodeHandle &nh) {
    nh.param("limit", m_limit, 2.0);
    nh.param("floor", m_floor, -6.0);
    nh.param("drop_nan", m_dropNan, false);
    m_pub = nh.advertise<std_msgs::UInt8>("bits", 1000);
    m_valuePub = nh.advertise<std_msgs::Float64>("values", 1000);
    m_sub = nh.subscribe("input", 1000, &NanSafe::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    const double v = msg->data;
    std_msgs::UInt8 bits;
    if (v > m_limit)
      bits.data += 1;
    if (!(v <= m_limit))
      bits.data += 2;
    if (v != m_limit)
      bits.data += 4;
    if (!(v >= m_floor))
      bits.data += 8;
    m_pub.publish(bits);

    if (std::isnan(v) && m_dropNan)
      return;
    if (not(v < m_floor))
      m_valuePub.publish(msg);
  }

  ros::Publisher m_pub, m_valuePub;
  ros::Subscriber m_sub;
  double m_limit, m_floor;
  bool m_dropNan;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "cmp_nan");
  ros::NodeHandle nh;
  NanSafe node(nh);
  ros::spin();
}
