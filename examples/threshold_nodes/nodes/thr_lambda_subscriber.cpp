// The callbacks are lambdas: one captures the threshold by value, one by
// reference, one captures what the other decided.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/UInt64.h>

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_lambda_subscriber");
  ros::NodeHandle nh;

  const double upper = nh.param("upper", 4.0);
  double lower = -4.0;
  nh.getParam("lower", lower);
  int every = 2;
  nh.getParam("every", every);

  ros::Publisher upper_pub = nh.advertise<std_msgs::Float64>("upper", 1000);
  ros::Publisher lower_pub = nh.advertise<std_msgs::Float64>("lower", 1000);
  ros::Publisher count_pub = nh.advertise<std_msgs::UInt64>("count", 1000);

  auto on_upper = [upper, upper_pub](const std_msgs::Float64::ConstPtr &msg) {
    if (msg->data > upper)
      upper_pub.publish(msg);
  };

  int below = 0;
  auto on_lower = [&](const std_msgs::Float64::ConstPtr &msg) {
    if (msg->data < lower) {
      ++below;
      lower_pub.publish(msg);
    }
    if (below == every) {
      std_msgs::UInt64 count;
      count.data = static_cast<std::uint64_t>(below);
      count_pub.publish(count);
      below = 0;
    }
  };

  ros::Subscriber upper_sub =
      nh.subscribe<std_msgs::Float64>("input", 1000, on_upper);
  ros::Subscriber lower_sub =
      nh.subscribe<std_msgs::Float64>("input", 1000, on_lower);
  ros::spin();
  return 0;
}
