// Two inputs with a callback each: the same function is called with either's
// threshold and publisher; a third parameter is used by one alone.
#include <map>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Channel {
public:
  Channel(ros::NodeHandle &nh, const std::string &topic, double limit)
      : limit_(limit), pub_(nh.advertise<std_msgs::Float64>(topic, 1000)) {}

  bool offer(double value) {
    if (value < limit_)
      return false;
    std_msgs::Float64 msg;
    msg.data = value;
    pub_.publish(msg);
    return true;
  }

private:
  double limit_;
  ros::Publisher pub_;
};

class Mixer {
public:
  Mixer(ros::NodeHandle &nh)
      : input_channel_(nh, "output", nh.param("input_limit", -1.0)),
        aux_channel_(nh, "aux_output", nh.param("aux_limit", 1.0)) {
    nh.param("aux_gate", aux_gate_, 8.0);
    input_sub_ = nh.subscribe("input", 1000, &Mixer::inputCb, this);
    aux_sub_ = nh.subscribe("aux", 1000, &Mixer::auxCb, this);
  }

private:
  void inputCb(const std_msgs::Float64::ConstPtr &msg) {
    if (!input_channel_.offer(msg->data))
      ++refused_;
  }

  void auxCb(const std_msgs::Float64::ConstPtr &msg) {
    if (msg->data <= aux_gate_)
      aux_channel_.offer(msg->data);
  }

  Channel input_channel_;
  Channel aux_channel_;
  ros::Subscriber input_sub_, aux_sub_;
  double aux_gate_;
  int refused_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_two_inputs");
  ros::NodeHandle nh;
  Mixer mixer(nh);
  ros::spin();
  return 0;
}
