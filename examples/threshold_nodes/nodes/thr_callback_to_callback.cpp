// A state that a threshold sets in one callback is read in another. Both are
// subscribed to the same topic, and so called in turn for each message.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class ArmedRelay {
public:
  ArmedRelay() {
    nh_.param("arm_above", arm_above_, 3.0);
    nh_.param("disarm_below", disarm_below_, -3.0);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    arm_sub_ = nh_.subscribe("input", 1000, &ArmedRelay::armCallback, this);
    fire_sub_ = nh_.subscribe("input", 1000, &ArmedRelay::fireCallback, this);
  }

private:
  void armCallback(const std_msgs::Float64::ConstPtr &msg) {
    if (msg->data > arm_above_)
      armed_ = true;
    else if (msg->data < disarm_below_)
      armed_ = false;
  }

  void fireCallback(const std_msgs::Float64::ConstPtr &msg) {
    if (armed_)
      pub_.publish(msg);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber arm_sub_;
  ros::Subscriber fire_sub_;
  double arm_above_, disarm_below_;
  bool armed_ = false;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_callback_to_callback");
  ArmedRelay relay;
  ros::spin();
  return 0;
}
