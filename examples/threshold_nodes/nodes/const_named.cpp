// Named constants of the node itself: a local, a file static, a member
// initialised in the class, a function's result and a template argument.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>

static const double kAlarm = 6.5;

static double zeroBand() { return 0.75; }

template <int Every> class Every_ {
public:
  bool next() { return ++count_ % Every == 0; }

private:
  int count_ = 0;
};

class Node {
public:
  Node() {
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    alarm_pub_ = nh_.advertise<std_msgs::Int32>("alarm", 1000);
    sub_ = nh_.subscribe("input", 1000, &Node::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    const int patience = 2;
    const double size = std::fabs(msg->data);
    alarms_ = size > kAlarm ? alarms_ + 1 : 0;
    if (alarms_ == patience) {
      std_msgs::Int32 alarm;
      alarm.data = alarms_;
      alarm_pub_.publish(alarm);
    }
    if (size < zeroBand())
      return;
    if (size > slope_ && third_.next())
      pub_.publish(msg);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_, alarm_pub_;
  ros::Subscriber sub_;
  const double slope_ = 1.25;
  int alarms_ = 0;
  Every_<3> third_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "const_named");
  Node node;
  ros::spin();
  return 0;
}
