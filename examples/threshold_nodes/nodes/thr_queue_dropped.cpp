// Negative: the values that a threshold lets into the queue are only counted
// by the timer; the queue of all values next to it is what is published.
#include <deque>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class TwoQueues {
public:
  TwoQueues() {
    nh_.param("interesting_above", interesting_above_, 5.0);
    nh_.param("max_interesting", max_interesting_, 4);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &TwoQueues::input, this);
    timer_ = nh_.createTimer(ros::Duration(0.01), &TwoQueues::drain, this);
  }

private:
  void input(const std_msgs::Float64::ConstPtr &msg) {
    all_.push_back(*msg);
    if (msg->data > interesting_above_)
      interesting_.push_back(msg->data);
  }

  void drain(const ros::TimerEvent &) {
    for (const auto &msg : all_)
      pub_.publish(msg);
    all_.clear();
    const int interesting = static_cast<int>(interesting_.size());
    if (interesting > max_interesting_)
      ROS_INFO("%d interesting values at once", interesting);
    interesting_.clear();
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  ros::Timer timer_;
  std::deque<std_msgs::Float64> all_;
  std::deque<double> interesting_;
  double interesting_above_;
  int max_interesting_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_queue_dropped");
  TwoQueues node;
  ros::spin();
  return 0;
}
