// A throw guarded by a threshold: the publish behind it in the try block, the
// one in the handler, and one after the try whose value the handler set.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>
#include <std_msgs/String.h>
#include <stdexcept>

class CheckedRelay {
public:
  CheckedRelay() {
    nh_.param("ceiling", ceiling_, 6.0);
    nh_.param("ground", ground_, -6.0);
    relay_pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    error_pub_ = nh_.advertise<std_msgs::String>("errors", 1000);
    code_pub_ = nh_.advertise<std_msgs::Int32>("codes", 1000);
    sub_ = nh_.subscribe("input", 1000, &CheckedRelay::relay, this);
  }

private:
  void relay(const std_msgs::Float64::ConstPtr &msg) {
    try {
      if (msg->data > ceiling_)
        throw std::out_of_range("above the ceiling");
      relay_pub_.publish(msg);
    } catch (const std::out_of_range &e) {
      std_msgs::String error;
      error.data = e.what();
      error_pub_.publish(error);
    }

    std_msgs::Int32 code;
    try {
      if (msg->data < ground_)
        throw 3;
      code.data = 0;
    } catch (int number) {
      code.data = number;
    }
    code_pub_.publish(code);
  }

  ros::NodeHandle nh_;
  ros::Publisher relay_pub_, error_pub_, code_pub_;
  ros::Subscriber sub_;
  double ceiling_, ground_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_exception");
  CheckedRelay relay;
  ros::spin();
  return 0;
}
