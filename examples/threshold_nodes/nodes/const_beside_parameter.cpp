// Hard-coded constants in the same conditions as parameters.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

static double max_current;
static bool braking_allowed;

class Motor {
public:
  explicit Motor(ros::NodeHandle &nh)
      : pub_(nh.advertise<std_msgs::Float64>("output", 1000)),
        brake_pub_(nh.advertise<std_msgs::Float64>("brake", 1000)) {}

  void command(const std_msgs::Float64::ConstPtr &msg) {
    if (msg->data > max_current || msg->data < -9.5)
      return;
    if (braking_allowed && msg->data < 0.25)
      brake_pub_.publish(msg);
    if (++warmup_ > 10)
      pub_.publish(msg);
  }

private:
  ros::Publisher pub_, brake_pub_;
  int warmup_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "const_beside_parameter");
  ros::NodeHandle nh;
  nh.param("max_current", max_current, 8.0);
  nh.param("braking_allowed", braking_allowed, true);
  Motor motor(nh);
  ros::Subscriber sub = nh.subscribe("input", 1000, &Motor::command, &motor);
  ros::spin();
  return 0;
}
