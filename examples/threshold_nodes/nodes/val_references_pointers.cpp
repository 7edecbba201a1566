// Thresholds behind references and pointers, to locals, members and arrays.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

namespace {

struct Limits {
  double soft;
  double hard;
};

struct View {
  const double *soft;
  const double &hard;
};

class Checker {
public:
  Checker(const Limits *limits, const int &hold, ros::Publisher *pub)
      : limits_(limits), hold_(hold), pub_(pub) {}

  void check(const std_msgs::Float64::ConstPtr &msg) {
    View view{&limits_->soft, limits_->hard};
    if (msg->data > *view.soft)
      ++exceeded_;
    if (msg->data > view.hard)
      exceeded_ += 5;
    if (exceeded_ < hold_)
      return;
    exceeded_ = 0;
    pub_->publish(msg);
  }

private:
  const Limits *limits_;
  const int &hold_;
  ros::Publisher *pub_;
  int exceeded_ = 0;
};

void fill(ros::NodeHandle *nh, double *target, const char *name, double value) {
  nh->param(name, *target, value);
}

} // namespace

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_references_pointers");
  ros::NodeHandle nh;
  Limits limits;
  double *soft = &limits.soft;
  fill(&nh, soft, "soft_limit", 2.0);
  fill(&nh, &limits.hard, "hard_limit", 8.0);
  int hold = 4;
  int &alias = hold;
  nh.getParam("hold", alias);

  ros::Publisher pub = nh.advertise<std_msgs::Float64>("output", 1000);
  Checker checker(&limits, hold, &pub);
  ros::Subscriber sub = nh.subscribe("input", 1000, &Checker::check, &checker);
  ros::spin();
  return 0;
}
