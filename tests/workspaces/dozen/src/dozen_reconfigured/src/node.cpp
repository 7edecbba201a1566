#include <dozen_reconfigured/DozenConfig.h>
#include <dynamic_reconfigure/server.h>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Node {
public:
  Node() : publisher_(handle_.advertise<std_msgs::Float64>("out", 1)) {
    server_.setCallback([this](dozen_reconfigured::DozenConfig &config, uint32_t) {
      threshold_ = config.threshold;
    });
    subscriber_ = handle_.subscribe("in", 1, &Node::receive, this);
  }

private:
  void receive(const std_msgs::Float64 &message) {
    if (message.data > threshold_) // TPC ~threshold
      publisher_.publish(message);
  }
  ros::NodeHandle handle_;
  dynamic_reconfigure::Server<dozen_reconfigured::DozenConfig> server_;
  double threshold_ = 0;
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "reconfigured_node");
  Node node;
  ros::spin();
}
