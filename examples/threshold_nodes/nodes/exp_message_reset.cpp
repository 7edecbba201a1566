// Negative twin of exp_message_fields: the message that is filled conditionally
// is assigned anew as a whole before the publish.
#include <ros/ros.h>
#include <std_msgs/ColorRGBA.h>
#include <std_msgs/Float64.h>

class StatusLight {
public:
  StatusLight() {
    nh_.param("light/red_above", red_above_, 6.0);
    nh_.param("light/blink", blink_, false);
    pub_ = nh_.advertise<std_msgs::ColorRGBA>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &StatusLight::show, this);
  }

private:
  void show(const std_msgs::Float64::ConstPtr &msg) {
    std_msgs::ColorRGBA color;
    if (msg->data > red_above_)
      color.r = 1.0;
    if (blink_)
      color.a = 0.5;
    ROS_DEBUG("preview %f %f", color.r, color.a);

    color = std_msgs::ColorRGBA();
    color.g = msg->data < 0.0 ? 0.0 : 1.0;
    pub_.publish(color);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double red_above_;
  bool blink_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_message_reset");
  StatusLight light;
  ros::spin();
  return 0;
}
