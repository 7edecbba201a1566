// Thresholds in constructor initialiser lists, in a member object, in a base
// class and in a delegating constructor.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Debouncer {
public:
  explicit Debouncer(int needed) : needed_(needed) {}
  bool operator()(bool raw) {
    run_ = raw ? run_ + 1 : 0;
    return run_ >= needed_;
  }

private:
  const int needed_;
  int run_ = 0;
};

class Ranged {
protected:
  Ranged(double low, double high) : low_{low}, high_{high} {}
  bool inside(double v) const { return v >= low_ && v <= high_; }

private:
  double low_;
  double high_;
};

class Presence : private Ranged {
public:
  Presence() : Presence(ros::NodeHandle()) {}
  explicit Presence(ros::NodeHandle nh)
      : Ranged(nh.param("near", -3.0), nh.param("far", 6.0)),
        debounce_(nh.param("needed", 2)), spread_(nh.param("spread", 4.0)),
        pub_(nh.advertise<std_msgs::Float64>("output", 1000)),
        sub_(nh.subscribe("input", 1000, &Presence::onInput, this)) {}

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    const double change = msg->data - last_;
    last_ = msg->data;
    if (change >= spread_)
      return;
    if (debounce_(inside(msg->data)))
      pub_.publish(msg);
  }

  Debouncer debounce_;
  const double spread_;
  double last_ = 0.0;
  ros::Publisher pub_;
  ros::Subscriber sub_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_initialiser_list");
  Presence presence;
  ros::spin();
  return 0;
}
