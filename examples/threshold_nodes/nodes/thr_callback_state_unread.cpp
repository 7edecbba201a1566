// Negative twin of thr_callback_to_callback: the other callback reads another
// state, the one that the threshold sets is only logged.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class ArmedRelay {
public:
  ArmedRelay() {
    nh_.param("arm_above", arm_above_, 3.0);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    arm_sub_ = nh_.subscribe("input", 1000, &ArmedRelay::armCallback, this);
    fire_sub_ = nh_.subscribe("input", 1000, &ArmedRelay::fireCallback, this);
  }

private:
  void armCallback(const std_msgs::Float64::ConstPtr &msg) {
    armed_ = false;
    if (msg->data > arm_above_)
      armed_ = true;
    loaded_ = msg->data > 0.0;
  }

  void fireCallback(const std_msgs::Float64::ConstPtr &msg) {
    ROS_DEBUG_STREAM("armed: " << armed_);
    if (loaded_)
      pub_.publish(msg);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber arm_sub_;
  ros::Subscriber fire_sub_;
  double arm_above_;
  bool armed_ = false;
  bool loaded_ = false;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_callback_state_unread");
  ArmedRelay relay;
  ros::spin();
  return 0;
}
