// A member that is read and at once overwritten, before any callback runs.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Pinned {
public:
  explicit Pinned(ros::NodeHandle nh) {
    nh.param("limit", limit_, -1.0);
    limit_ = -2.0; // the parameter is obsolete, the hardware fixes the limit
    pub_ = nh.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh.subscribe("input", 1000, &Pinned::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64 &msg) {
    if (msg.data < limit_)
      pub_.publish(msg);
  }

  ros::Publisher pub_;
  ros::Subscriber sub_;
  double limit_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "read_overwritten_member");
  Pinned pinned{ros::NodeHandle()};
  ros::spin();
}
