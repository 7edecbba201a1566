// The twin of const_integers and const_floats: the constants guard the log and
// counters that nobody publishes.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

static int high = 0;
static int total = 0;
static ros::Publisher pub;

static void report() { ROS_INFO("%d of %d are high", high, total); }

static void onInput(const std_msgs::Float64::ConstPtr &msg) {
  if (msg->data > 5.5)
    ++high;
  if (++total % 100 == 0)
    report();
  ROS_WARN_COND(msg->data < -9.0, "very low: %g", msg->data);
  std_msgs::Float64 out;
  if (msg->data > 3.0)
    out.data = 3.0;
  out.data = 2 * msg->data;
  pub.publish(out);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "const_cut");
  ros::NodeHandle nh;
  pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, onInput);
  ros::spin();
  return 0;
}
