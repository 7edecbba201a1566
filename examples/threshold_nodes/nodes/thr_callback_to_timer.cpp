// The callback raises a count where a threshold is exceeded, a ros::Timer
// publishes one message for each.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/UInt32.h>

class AlarmNode {
public:
  AlarmNode() {
    nh_.param("alarm_above", alarm_above_, 5.0);
    nh_.param("max_alarms", max_alarms_, 20);
    pub_ = nh_.advertise<std_msgs::UInt32>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &AlarmNode::onInput, this);
    timer_ = nh_.createTimer(ros::Duration(0.01), &AlarmNode::onTimer, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    if (msg->data > alarm_above_)
      ++raised_;
  }

  void onTimer(const ros::TimerEvent &) {
    while (sent_ < raised_) {
      if (sent_ >= max_alarms_)
        return;
      std_msgs::UInt32 alarm;
      alarm.data = sent_++;
      pub_.publish(alarm);
    }
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  ros::Timer timer_;
  double alarm_above_;
  int max_alarms_;
  int raised_ = 0;
  int sent_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_callback_to_timer");
  AlarmNode node;
  ros::spin();
  return 0;
}
