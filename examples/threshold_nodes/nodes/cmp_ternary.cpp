// Conditional expressions: in an initialiser, nested, as an argument, as the
// choice of a publisher, and one whose result is not published.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

struct Thresholds {
  double split, upper, lower, flip, note;
};

class Chooser {
public:
  Chooser(ros::NodeHandle &nh, const Thresholds &t) : t_(t) {
    a_pub_ = nh.advertise<std_msgs::Float64>("a", 1000);
    b_pub_ = nh.advertise<std_msgs::Float64>("b", 1000);
    sub_ = nh.subscribe("input", 1000, &Chooser::onInput, this);
  }

private:
  static std_msgs::Float64 make(double value) {
    std_msgs::Float64 msg;
    msg.data = value;
    return msg;
  }

  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    const double v = msg->data;
    const double limited = v > t_.upper ? t_.upper : v < t_.lower ? -1.0 : v;
    ros::Publisher &pub = v < t_.split ? a_pub_ : b_pub_;
    pub.publish(make(t_.flip >= v ? limited : -limited));
    notes_ += v > t_.note ? 1 : 0;
  }

  const Thresholds t_;
  ros::Publisher a_pub_, b_pub_;
  ros::Subscriber sub_;
  int notes_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "cmp_ternary");
  ros::NodeHandle nh;
  Thresholds t;
  nh.param("split", t.split, 0.5);
  nh.param("upper", t.upper, 7.0);
  nh.param("lower", t.lower, -7.0);
  nh.param("flip", t.flip, 2.0);
  nh.param("note", t.note, 4.0);
  Chooser chooser(nh, t);
  ros::spin();
  return 0;
}
