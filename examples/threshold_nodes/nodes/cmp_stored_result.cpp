// The outcome of a comparison is kept in a variable: tested later, combined,
// negated twice, and published as it is.
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>

class Latch {
public:
  explicit Latch(ros::NodeHandle nh) {
    nh.param("trip", trip_, 7.0);
    nh.param("release", release_, -2.0);
    nh.param("step", step_, 5.0);
    nh.param("reported", reported_, 1.0);
    pub_ = nh.advertise<std_msgs::Float64>("output", 1000);
    state_pub_ = nh.advertise<std_msgs::Bool>("state", 1000);
    sub_ = nh.subscribe("input", 1000, &Latch::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    const bool tripped = msg->data > trip_;
    released_ = msg->data < release_;
    bool large = false;
    large |= std::fabs(msg->data - last_) >= step_;
    last_ = msg->data;

    if (tripped)
      latched_ = true;
    else if (latched_ && !!released_)
      latched_ = false;
    if (!latched_ && large)
      pub_.publish(msg);

    std_msgs::Bool state;
    state.data = msg->data > reported_;
    state_pub_.publish(state);
  }

  ros::Publisher pub_, state_pub_;
  ros::Subscriber sub_;
  double trip_, release_, step_, reported_;
  double last_ = 0.0;
  bool latched_ = false;
  bool released_ = false;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "cmp_stored_result");
  Latch latch{ros::NodeHandle()};
  ros::spin();
}
