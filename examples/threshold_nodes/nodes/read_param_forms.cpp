// The three forms of NodeHandle::param: an output variable with a default, the
// returned value, and the returned value compared where it is read.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class SpeedGate {
public:
  explicit SpeedGate(ros::NodeHandle &nh) : nh_(nh) {
    nh_.param("max_speed", max_speed_, 6.0);
    min_speed_ = nh_.param("min_speed", -4.0);
    burst_ = nh_.param<int>("burst", 3);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &SpeedGate::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    const double speed = msg->data;
    if (speed > max_speed_)
      return;
    if (speed < min_speed_)
      return;

    int repeat = 1;
    if (speed > nh_.param("ceiling", 2.0))
      repeat = burst_;

    std_msgs::Float64 out;
    out.data = speed;
    for (int i = 0; i < repeat; ++i)
      pub_.publish(out);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double max_speed_;
  double min_speed_;
  int burst_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "read_param_forms");
  ros::NodeHandle nh;
  SpeedGate gate(nh);
  ros::spin();
  return 0;
}
