// A message that the node receives, and messages of the same class that it
// fills.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Relay {
public:
  explicit Relay(ros::NodeHandle &nh) {
    nh.param("idle", idle_, 2.0);
    nh.param("limit", limit_, 5.0);
    logged_ = &own_;
    pub_ = nh.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh.subscribe("input", 1000, &Relay::onInput, this);
  }

private:
  // Writes by a pointer whose object is not seen here.
  static void fill(std_msgs::Float64 *message, double value) {
    message->data = value;
  }

  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    if (msg->data < idle_)
      fill(logged_, msg->data);
    relay(*msg);
    ROS_DEBUG("%f", logged_->data);
  }

  void relay(const std_msgs::Float64 &msg) {
    if (msg.data > limit_)
      return;
    pub_.publish(msg);
  }

  double idle_, limit_;
  std_msgs::Float64 own_;
  std_msgs::Float64 *logged_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_received_message");
  ros::NodeHandle nh;
  Relay relay(nh);
  ros::spin();
  return 0;
}
