// Flags decide at the start what the node does: whether a publisher is
// advertised at all, and whether a callback is subscribed.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Debuggable {
public:
  Debuggable() : pnh_("~") {
    pnh_.param("publish_squares", publish_squares_, true);
    bool relay = true;
    pnh_.getParam("relay", relay);
    if (publish_squares_)
      square_pub_ = nh_.advertise<std_msgs::Float64>("squares", 1000);
    relay_pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Debuggable::square, this);
    if (relay)
      relay_sub_ = nh_.subscribe("input", 1000, &Debuggable::relay, this);
  }

private:
  void square(const std_msgs::Float64::ConstPtr &msg) {
    if (!square_pub_)
      return;
    std_msgs::Float64 squared;
    squared.data = msg->data * msg->data;
    square_pub_.publish(squared);
  }

  void relay(const std_msgs::Float64::ConstPtr &msg) {
    relay_pub_.publish(msg);
  }

  ros::NodeHandle nh_, pnh_;
  bool publish_squares_;
  ros::Publisher square_pub_, relay_pub_;
  ros::Subscriber sub_, relay_sub_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_optional_publisher");
  Debuggable node;
  ros::spin();
  return 0;
}
