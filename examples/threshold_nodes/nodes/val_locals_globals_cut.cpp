// The twin of val_locals_globals: the same kinds of variables, but nothing
// that is published depends on the comparisons.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

double g_upper = 0.0;
static int s_max_count = 0;
static int s_high = 0;
static unsigned long s_total = 0;
static unsigned long s_late = 0;

static ros::Publisher g_pub;

static void inputCallback(const std_msgs::Float64::ConstPtr &msg) {
  static const double zone = ros::param::param("zero_zone", 0.5);
  double value = msg->data;
  if (value > g_upper)
    ++s_high;
  if (++s_total > static_cast<unsigned long>(s_max_count))
    s_late++;
  std_msgs::Float64 out;
  out.data = 1.0;
  if (std::fabs(value) < zone)
    out.data = 0.0;
  out.data = value;
  g_pub.publish(out);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_locals_globals_cut");
  ros::NodeHandle nh;
  nh.param("upper", g_upper, 5.0);
  nh.param("max_count", s_max_count, 100);
  g_pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, inputCallback);
  ros::spin();
  ROS_INFO("%d high, %lu late", s_high, s_late);
  return 0;
}
