// Thresholds in a global, a file static, a function static, an anonymous
// namespace and a local of main.
#include <queue>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

double g_upper = 0.0;
static int s_min_count = 0;

namespace {
float lower = 0.0f;
std::queue<double> inbox;
} // namespace

bool nearZero(double value) {
  static const double zone = ros::param::param("zero_zone", 0.5);
  return std::fabs(value) < zone;
}

void inputCallback(const std_msgs::Float64::ConstPtr &msg) {
  inbox.push(msg->data);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_locals_globals");
  ros::NodeHandle nh;
  nh.param("upper", g_upper, 5.0);
  nh.getParam("min_count", s_min_count);
  lower = nh.param("lower", -5.0f);
  double jump;
  nh.param("jump", jump, 8.0);

  ros::Publisher pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, inputCallback);

  double last = 0.0;
  int count = 0;
  ros::Rate rate(100);
  while (ros::ok()) {
    ros::spinOnce();
    for (; !inbox.empty(); inbox.pop()) {
      const double value = inbox.front();
      const double step = std::fabs(value - last);
      last = value;
      if (step > jump)
        continue;
      if (value > g_upper)
        continue;
      if (value < lower)
        continue;
      if (nearZero(value))
        continue;
      if (++count <= s_min_count)
        continue;
      std_msgs::Float64 out;
      out.data = value;
      pub.publish(out);
    }
    rate.sleep();
  }
  return 0;
}
