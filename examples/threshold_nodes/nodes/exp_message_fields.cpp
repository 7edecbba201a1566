// The fields of a message that is always published are filled conditionally.
#include <ros/ros.h>
#include <std_msgs/ColorRGBA.h>
#include <std_msgs/Float64.h>

class StatusLight {
public:
  StatusLight() {
    nh_.param("light/red_above", red_above_, 6.0);
    nh_.param("light/green_below", green_below_, 0.0);
    nh_.param("light/blink", blink_, false);
    pub_ = nh_.advertise<std_msgs::ColorRGBA>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &StatusLight::show, this);
  }

private:
  void show(const std_msgs::Float64::ConstPtr &msg) {
    std_msgs::ColorRGBA color;
    color.a = 1.0;
    if (msg->data > red_above_)
      color.r = 1.0;
    else if (msg->data < green_below_)
      color.g = 1.0;
    if (blink_)
      color.a = 0.5;
    pub_.publish(color);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double red_above_, green_below_;
  bool blink_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_message_fields");
  StatusLight light;
  ros::spin();
  return 0;
}
