// A state machine: thresholds decide the state, a switch on the state decides
// what is published.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/String.h>

namespace gripper {

enum State { IDLE, CLOSING, HOLDING };

class Controller {
  ros::NodeHandle nh;
  ros::Publisher force_pub;
  ros::Publisher event_pub;
  ros::Subscriber sub;
  State state = IDLE;
  double close_force = 2.0;
  double hold_force = 6.0;
  double release_force = -2.0;
  int max_hold = 5;
  int held = 0;

  void event(const std::string &text) {
    std_msgs::String msg;
    msg.data = text;
    event_pub.publish(msg);
  }

public:
  Controller() : nh("gripper") {
    nh.getParam("close_force", close_force);
    nh.getParam("hold_force", hold_force);
    nh.getParam("release_force", release_force);
    nh.getParam("max_hold", max_hold);
    ros::NodeHandle public_nh;
    force_pub = public_nh.advertise<std_msgs::Float64>("output", 1000);
    event_pub = public_nh.advertise<std_msgs::String>("events", 1000);
    sub = public_nh.subscribe("input", 1000, &Controller::update, this);
  }

  void update(const std_msgs::Float64ConstPtr &force) {
    switch (state) {
    case IDLE:
      if (force->data > close_force)
        state = CLOSING;
      break;
    case CLOSING:
      event("closing");
      if (force->data >= hold_force) {
        state = HOLDING;
        held = 0;
      }
      break;
    case HOLDING:
      force_pub.publish(force);
      ++held;
      if (force->data < release_force)
        state = IDLE;
      else if (held > max_hold)
        state = IDLE;
      break;
    }
  }
};

} // namespace gripper

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_switch_state");
  gripper::Controller controller;
  ros::spin();
}
