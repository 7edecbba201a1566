// Private and namespaced handles: a member initialised in the constructor's
// list, a handle made on the spot, a handle made from another handle.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Gripper {
public:
  Gripper()
      : nh_(), private_nh_("~"), arm_nh_("arm"),
        filter_nh_(private_nh_, "filter"),
        grip_(private_nh_.param("grip", 6.0)) {
    private_nh_.param("force_limit", force_limit_, 4.0);
    arm_nh_.param<double>("force_limit", arm_limit_, -4.0);
    filter_nh_.param("window", window_, 2);
    ros::NodeHandle("hand").getParam("squeeze", squeeze_);
    ros::NodeHandle fingers(nh_, "fingers");
    fingers.getParam("spread", spread_);

    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Gripper::forceCallback, this);
  }

private:
  void forceCallback(const std_msgs::Float64::ConstPtr &msg) {
    const double force = msg->data;
    sum_ += force;
    if (++n_ < window_)
      return;
    std_msgs::Float64 mean;
    mean.data = sum_ / n_;
    sum_ = 0;
    n_ = 0;
    if (force > force_limit_)
      mean.data += 100;
    if (force < arm_limit_)
      mean.data += 200;
    if (mean.data > squeeze_)
      mean.data += 1000;
    if (mean.data < spread_)
      mean.data -= 1000;
    if (force < grip_)
      pub_.publish(mean);
  }

  ros::NodeHandle nh_, private_nh_, arm_nh_, filter_nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double grip_;
  double force_limit_;
  double arm_limit_;
  double squeeze_ = 1.0;
  double spread_ = -3.0;
  int window_;
  double sum_ = 0;
  int n_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "read_handles");
  Gripper gripper;
  ros::spin();
  return 0;
}
