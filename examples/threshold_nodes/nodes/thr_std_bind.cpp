// Callbacks made by std::bind and kept in a std::function: the subscriber's
// callback calls a handler that was chosen by a flag.
#include <functional>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Dispatcher {
public:
  using Handler = std::function<void(double)>;

  Dispatcher() : pnh_("~") {
    pnh_.param("strict", strict_, true);
    pnh_.param("strict_limit", strict_limit_, 6.0);
    pnh_.param("loose_limit", loose_limit_, 2.0);
    using std::placeholders::_1;
    if (strict_)
      handler_ = std::bind(&Dispatcher::handleStrict, this, _1);
    else
      handler_ = std::bind(&Dispatcher::handleLoose, this, _1);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe<std_msgs::Float64>(
        "input", 1000, std::bind(&Dispatcher::dispatch, this, _1));
  }

private:
  void dispatch(const std_msgs::Float64::ConstPtr &msg) { handler_(msg->data); }

  void handleStrict(double value) {
    if (value > strict_limit_)
      send(value);
  }

  void handleLoose(double value) {
    if (value > loose_limit_)
      send(value);
  }

  void send(double value) {
    std_msgs::Float64 msg;
    msg.data = value;
    pub_.publish(msg);
  }

  ros::NodeHandle nh_, pnh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  Handler handler_;
  bool strict_;
  double strict_limit_, loose_limit_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_std_bind");
  Dispatcher dispatcher;
  ros::spin();
  return 0;
}
