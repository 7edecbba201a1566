// Comparisons that macros write, one macro used for several parameters.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

#define EXCEEDS(value, limit) ((value) > (limit))
#define RETURN_UNLESS(condition)                                               \
  do {                                                                         \
    if (!(condition))                                                          \
      return;                                                                  \
  } while (0)
#define LIMIT(member) config_.member##_limit_
#define COUNT_BELOW(value, limit, counter)                                     \
  do {                                                                         \
    if ((value) < (limit))                                                     \
      ++(counter);                                                             \
  } while (0)

class Spindle {
public:
  Spindle() {
    nh_.param("torque_limit", LIMIT(torque), 7.0);
    nh_.param("heat_limit", LIMIT(heat), 5.0);
    nh_.param("idle_limit", LIMIT(idle), -5.0);
    nh_.param("stall_limit", LIMIT(stall), -9.0);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Spindle::input, this);
  }
  ~Spindle() { ROS_INFO("%d stalls", stalls_); }

private:
  void input(const std_msgs::Float64ConstPtr &msg) {
    std_msgs::Float64 out = *msg;
    if (EXCEEDS(msg->data, LIMIT(torque)))
      return;
    if (EXCEEDS(msg->data, config_.heat_limit_))
      out.data = config_.heat_limit_;
    COUNT_BELOW(msg->data, LIMIT(stall), stalls_);
    RETURN_UNLESS(msg->data >= LIMIT(idle));
    pub_.publish(out);
  }

  struct {
    double torque_limit_, heat_limit_, idle_limit_, stall_limit_;
  } config_;
  int stalls_ = 0;
  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_macros");
  Spindle spindle;
  ros::spin();
  return 0;
}
