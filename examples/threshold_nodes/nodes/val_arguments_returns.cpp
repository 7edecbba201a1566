// Thresholds that travel as arguments, return values and out-arguments.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int8.h>

static double s_gap;

static double readGap(const ros::NodeHandle &nh) {
  double gap;
  nh.param("gap", gap, 3.0);
  return gap;
}

static void readPair(const ros::NodeHandle &nh, double &inner, double *outer) {
  inner = nh.param("inner", 2.0);
  nh.param("outer", *outer, 7.0);
}

static bool within(double value, double limit) {
  return std::fabs(value) <= limit;
}

static int zone(double value, double inner, double outer) {
  if (within(value, inner))
    return 0;
  if (value < outer)
    return 1;
  return 2;
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_arguments_returns");
  ros::NodeHandle nh;
  s_gap = readGap(nh);
  double inner = 0.0, outer = 0.0;
  readPair(nh, inner, &outer);

  ros::Publisher zones = nh.advertise<std_msgs::Int8>("zone", 1000);
  ros::Publisher gaps = nh.advertise<std_msgs::Float64>("gap_output", 1000);
  double last = 0.0;
  ros::Subscriber sub = nh.subscribe<std_msgs::Float64>(
      "input", 1000, [=](const std_msgs::Float64::ConstPtr &msg) mutable {
        std_msgs::Int8 out;
        out.data = zone(msg->data, inner, outer);
        zones.publish(out);
        if (!within(msg->data - last, s_gap))
          gaps.publish(*msg);
        last = msg->data;
      });
  ros::spin();
  return 0;
}
