// Negative twin of thr_callback_to_timer: the timer that looks at what the
// threshold decided only keeps statistics.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class AlarmNode {
public:
  AlarmNode() {
    nh_.param("alarm_above", alarm_above_, 5.0);
    nh_.param("max_alarms", max_alarms_, 20);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &AlarmNode::onInput, this);
    timer_ =
        nh_.createWallTimer(ros::WallDuration(0.01), &AlarmNode::onTimer, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    pub_.publish(msg);
    if (msg->data > alarm_above_)
      ++raised_;
  }

  void onTimer(const ros::WallTimerEvent &) {
    while (seen_ < raised_) {
      ++seen_;
      if (seen_ >= max_alarms_)
        ROS_INFO_ONCE("many alarms");
    }
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  ros::WallTimer timer_;
  double alarm_above_;
  int max_alarms_;
  int raised_ = 0;
  int seen_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_timer_counts");
  AlarmNode node;
  ros::spin();
  return 0;
}
