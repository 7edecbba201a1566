// The array in a message grows conditionally and is published when a
// parameter's number of elements is reached.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>

namespace {
ros::Publisher histogram_pub;
std_msgs::Float64MultiArray pending;
double m_floor;
int m_capacity;
} // namespace

void append(const std_msgs::Float64ConstPtr &sample) {
  if (sample->data >= m_floor) {
    pending.data.push_back(sample->data);
  }
  if (static_cast<int>(pending.data.size()) == m_capacity) {
    histogram_pub.publish(pending);
    pending.data.clear();
  }
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_multi_array");
  ros::NodeHandle nh("histogram");
  nh.param("floor", m_floor, -4.0);
  nh.param("capacity", m_capacity, 6);
  ros::NodeHandle root;
  histogram_pub = root.advertise<std_msgs::Float64MultiArray>("output", 1000);
  ros::Subscriber sub = root.subscribe("input", 1000, append);
  ros::spin();
  return 0;
}
