// Negative twin of ctl_switch_state: the thresholds drive a state that no
// published message and no branch around one depends on.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

namespace gripper {

enum State { IDLE, CLOSING, HOLDING };

class Observer {
  ros::NodeHandle nh;
  ros::Publisher pub;
  ros::Subscriber sub;
  State state = IDLE;
  double close_force = 2.0;
  double hold_force = 6.0;
  int transitions = 0;

  void enter(State next) {
    state = next;
    ++transitions;
    ROS_DEBUG("state %d after %d transitions", state, transitions);
  }

public:
  Observer() {
    nh.getParam("close_force", close_force);
    nh.getParam("hold_force", hold_force);
    pub = nh.advertise<std_msgs::Float64>("output", 1000);
    sub = nh.subscribe("input", 1000, &Observer::update, this);
  }

  void update(const std_msgs::Float64ConstPtr &force) {
    switch (state) {
    case IDLE:
      if (force->data > close_force)
        enter(CLOSING);
      break;
    case CLOSING:
      if (force->data >= hold_force)
        enter(HOLDING);
      break;
    case HOLDING:
      enter(IDLE);
      break;
    }
    pub.publish(force);
  }
};

} // namespace gripper

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_dead_state");
  gripper::Observer observer;
  ros::spin();
}
