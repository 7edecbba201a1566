// Negative twin of exp_service_client: the service is called for every value,
// the thresholds only count how full it was.
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/UInt32.h>
#include <std_srvs/Trigger.h>

class LevelControl {
public:
  LevelControl() : spinner_(1, &queue_) {
    nh_.param("full", full_, 6.0);
    nh_.param("empty", empty_, -6.0);
    pub_ = nh_.advertise<std_msgs::UInt32>("output", 1000);
    service_nh_.setCallbackQueue(&queue_);
    server_ = service_nh_.advertiseService("exp_service_anyway/sample",
                                           &LevelControl::sample, this);
    spinner_.start();
    client_ = nh_.serviceClient<std_srvs::Trigger>("exp_service_anyway/sample");
    sub_ = nh_.subscribe("input", 1000, &LevelControl::level, this);
  }

private:
  bool sample(std_srvs::Trigger::Request &, std_srvs::Trigger::Response &res) {
    std_msgs::UInt32 samples;
    samples.data = ++samples_;
    pub_.publish(samples);
    res.success = true;
    return true;
  }

  void level(const std_msgs::Float64::ConstPtr &msg) {
    if (msg->data > full_)
      ++full_count_;
    else if (msg->data < empty_)
      ++empty_count_;
    std_srvs::Trigger trigger;
    client_.call(trigger);
    ROS_DEBUG("%u full, %u empty", full_count_, empty_count_);
  }

  ros::CallbackQueue queue_;
  ros::NodeHandle nh_;
  ros::NodeHandle service_nh_;
  ros::Publisher pub_;
  ros::ServiceServer server_;
  ros::AsyncSpinner spinner_;
  ros::ServiceClient client_;
  ros::Subscriber sub_;
  double full_, empty_;
  unsigned samples_ = 0, full_count_ = 0, empty_count_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_service_anyway");
  LevelControl control;
  ros::spin();
  return 0;
}
