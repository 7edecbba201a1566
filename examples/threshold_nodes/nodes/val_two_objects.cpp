// Two objects of one class: only the left one is configured from a parameter.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Threshold {
public:
  explicit Threshold(double limit) : limit_(limit) {}
  double limit() const { return limit_; }

private:
  double limit_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_two_objects");
  ros::NodeHandle nh;
  const Threshold left(nh.param("left_limit", 2.0));
  const Threshold right(4.0);

  ros::Publisher left_pub = nh.advertise<std_msgs::Float64>("left", 1000);
  ros::Publisher right_pub = nh.advertise<std_msgs::Float64>("right", 1000);
  ros::Subscriber sub = nh.subscribe<std_msgs::Float64>(
      "input", 1000, [&](const std_msgs::Float64::ConstPtr &msg) {
        if (msg->data > left.limit())
          left_pub.publish(msg);
        if (msg->data > right.limit())
          right_pub.publish(msg);
      });
  ros::spin();
  return 0;
}
