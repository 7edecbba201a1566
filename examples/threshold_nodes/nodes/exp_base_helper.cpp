// The base class holds the publisher and a helper that publishes; the derived
// class holds the threshold.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <string>

class NodeBase {
protected:
  explicit NodeBase(const std::string &topic)
      : pub_(nh_.advertise<std_msgs::Float64>(topic, 1000)) {}

  void send(double value) {
    std_msgs::Float64 msg;
    msg.data = value;
    pub_.publish(msg);
  }

  ros::NodeHandle nh_;

private:
  ros::Publisher pub_;
};

class SquelchNode : public NodeBase {
public:
  SquelchNode() : NodeBase("output") {
    nh_.param("squelch", squelch_, 1);
    sub_ = nh_.subscribe("input", 1000, &SquelchNode::audio, this);
  }

private:
  void audio(const std_msgs::Float64::ConstPtr &msg) {
    if (msg->data >= squelch_)
      send(msg->data);
  }

  ros::Subscriber sub_;
  int squelch_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_base_helper");
  SquelchNode node;
  ros::spin();
  return 0;
}
