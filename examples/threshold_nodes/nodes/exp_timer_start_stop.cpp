// Negative: a threshold starts and stops a timer, which is no exposing
// statement by itself; the timer's callback only logs.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Watchdog {
public:
  Watchdog() {
    nh_.param("watch_above", watch_above_, 2.0);
    nh_.param("release_below", release_below_, -2.0);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    timer_ = nh_.createTimer(ros::Duration(0.01), &Watchdog::tick, this, false,
                             false);
    sub_ = nh_.subscribe("input", 1000, &Watchdog::input, this);
  }

private:
  void input(const std_msgs::Float64::ConstPtr &msg) {
    if (msg->data > watch_above_)
      timer_.start();
    if (msg->data < release_below_)
      timer_.stop();
    pub_.publish(msg);
  }

  void tick(const ros::TimerEvent &) {
    ++ticks_;
    ROS_DEBUG("watching, tick %d", ticks_);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  ros::Timer timer_;
  double watch_above_, release_below_;
  int ticks_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_timer_start_stop");
  Watchdog watchdog;
  ros::spin();
  return 0;
}
