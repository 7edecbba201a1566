// A switch on an integer parameter chooses what is published; a second one, on
// an enumeration made from a parameter, whether it is.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

enum class Gate { Closed = 0, Open = 1, Positive = 2 };

class ModeSwitch {
public:
  ModeSwitch() : pnh_("~") {
    pnh_.param("mode", mode_, 1);
    gate_ = static_cast<Gate>(pnh_.param("gate", 2));
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &ModeSwitch::callback, this);
  }

private:
  void callback(const std_msgs::Float64::ConstPtr &msg) {
    std_msgs::Float64 out;
    switch (mode_) {
    case 0:
      out.data = msg->data;
      break;
    case 1:
      out.data = -msg->data;
      break;
    case 2:
      out.data = msg->data * msg->data;
      break;
    default:
      out.data = 0.0;
    }

    switch (gate_) {
    case Gate::Open:
      pub_.publish(out);
      break;
    case Gate::Positive:
      if (out.data > 0.0)
        pub_.publish(out);
      break;
    case Gate::Closed:
      break;
    }
  }

  ros::NodeHandle nh_;
  ros::NodeHandle pnh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  int mode_;
  Gate gate_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_switch_parameter");
  ModeSwitch node;
  ros::spin();
  return 0;
}
