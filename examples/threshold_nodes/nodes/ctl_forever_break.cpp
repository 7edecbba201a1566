// while (ros::ok()) around a for (;;) that is left by break; thresholds decide
// the break and the continue before the publish.
#include <deque>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

std::deque<double> g_queue;

void inputCallback(const std_msgs::Float64::ConstPtr &msg) {
  g_queue.push_back(msg->data);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_forever_break");
  ros::NodeHandle nh;
  ros::NodeHandle pnh("~");

  double pause_below = -7.0;
  double skip_above = 5.0;
  pnh.getParam("pause_below", pause_below);
  pnh.getParam("skip_above", skip_above);

  ros::Publisher pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, inputCallback);

  while (ros::ok()) {
    ros::spinOnce();
    for (;;) {
      if (g_queue.empty())
        break;
      const double value = g_queue.front();
      g_queue.pop_front();
      if (value < pause_below)
        break;
      if (value > skip_above)
        continue;
      std_msgs::Float64 out;
      out.data = value;
      pub.publish(out);
    }
    ros::WallDuration(0.005).sleep();
  }
  return 0;
}
