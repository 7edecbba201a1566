// Each of the six operators, the threshold on either side.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/UInt32.h>

struct Limits {
  double lt, le, gt, ge;
  int eq, ne;
} limits;

ros::Publisher right_pub;
ros::Publisher left_pub;

void right(double v, int n) {
  std_msgs::UInt32 bits;
  if (v < limits.lt)
    bits.data |= 1;
  if (v <= limits.le)
    bits.data |= 2;
  if (v > limits.gt)
    bits.data |= 4;
  if (v >= limits.ge)
    bits.data |= 8;
  if (n == limits.eq)
    bits.data |= 16;
  if (n != limits.ne)
    bits.data |= 32;
  right_pub.publish(bits);
}

void left(double v, int n) {
  std_msgs::UInt32 bits;
  if (limits.lt < v)
    bits.data |= 1;
  if (limits.le <= v)
    bits.data |= 2;
  if (limits.gt > v)
    bits.data |= 4;
  if (limits.ge >= v)
    bits.data |= 8;
  if (limits.eq == n)
    bits.data |= 16;
  if (limits.ne != n)
    bits.data |= 32;
  left_pub.publish(bits);
}

void callback(const std_msgs::Float64 &msg) {
  const int n = static_cast<int>(msg.data);
  right(msg.data, n);
  left(msg.data, n);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "cmp_operators");
  ros::NodeHandle nh;
  nh.param("lt", limits.lt, -3.0);
  nh.param("le", limits.le, -1.0);
  nh.param("gt", limits.gt, 1.0);
  nh.param("ge", limits.ge, 3.0);
  nh.param("eq", limits.eq, 2);
  nh.param("ne", limits.ne, -2);
  right_pub = nh.advertise<std_msgs::UInt32>("right", 1000);
  left_pub = nh.advertise<std_msgs::UInt32>("left", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, callback);
  ros::spin();
  return 0;
}
