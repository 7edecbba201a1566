// Parameters that are checked and replaced by a constant where they make no
// sense; the checks are comparisons themselves.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

static double gate;
static int keep;
static int keep_count = 0;
static ros::Publisher pub;

static bool readGate(ros::NodeHandle &nh) {
  nh.param("gate", gate, 4.0);
  if (gate <= 0.0) {
    ROS_WARN("the gate has to be positive, 1 is used");
    gate = 1.0;
  }
  nh.param("keep", keep, 2);
  if (keep < 1)
    return false;
  return true;
}

static void onInput(const std_msgs::Float64::ConstPtr &msg) {
  if (std::fabs(msg->data) > gate)
    return;
  if (++keep_count == keep) {
    keep_count = 0;
    pub.publish(msg);
  }
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "drv_corrected");
  ros::NodeHandle nh;
  if (!readGate(nh)) {
    ROS_FATAL("keep has to be at least 1");
    return 1;
  }
  pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, onInput);
  ros::spin();
  return 0;
}
