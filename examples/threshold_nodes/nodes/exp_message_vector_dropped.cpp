// Negative twin of exp_message_vector: the messages that were collected
// conditionally are counted in a log line and dropped.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <vector>

class Batcher {
public:
  Batcher() : received_(0) {
    ros::NodeHandle pnh("~");
    pnh.param("keep_above", keep_above_, 1.0);
    pnh.param("batch_size", batch_size_, 5);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Batcher::collect, this);
  }

private:
  void collect(const std_msgs::Float64::ConstPtr &msg) {
    pub_.publish(msg);
    if (msg->data > keep_above_)
      batch_.push_back(*msg);
    ++received_;
    if (received_ < batch_size_)
      return;
    ROS_INFO("%zu of %d kept", batch_.size(), received_);
    batch_.clear();
    received_ = 0;
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  std::vector<std_msgs::Float64> batch_;
  int received_;
  double keep_above_;
  int batch_size_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_message_vector_dropped");
  Batcher batcher;
  ros::spin();
  return 0;
}
