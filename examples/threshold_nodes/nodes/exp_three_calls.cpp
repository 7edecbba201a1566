// The publish stands three calls behind the threshold, through two classes and
// a function template.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

template <typename Message, typename Value>
void publishValue(const ros::Publisher &publisher, Value value) {
  Message message;
  message.data = value;
  publisher.publish(message);
}

class Arm {
public:
  explicit Arm(ros::NodeHandle &nh)
      : pub_(nh.advertise<std_msgs::Float64>("output", 1000)) {}
  void moveTo(double angle) { command(angle); }

private:
  void command(double angle) { publishValue<std_msgs::Float64>(pub_, angle); }

  ros::Publisher pub_;
};

class Planner {
public:
  explicit Planner(ros::NodeHandle &nh) : arm_(nh) {
    nh.param("planner/reach", reach_, 3.5);
    sub_ = nh.subscribe("input", 1000, &Planner::plan, this);
  }

private:
  void plan(const std_msgs::Float64::ConstPtr &goal) {
    ++plans_;
    if (goal->data <= reach_)
      arm_.moveTo(goal->data);
  }

  Arm arm_;
  ros::Subscriber sub_;
  double reach_;
  int plans_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_three_calls");
  ros::NodeHandle nh;
  Planner planner(nh);
  ros::spin();
  return 0;
}
