// Hard-coded integers that decide what is published; no parameter is read.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>

static ros::Publisher output_pub;
static ros::Publisher level_pub;
static int samples = 0;
static int negatives = 0;

static void inputCallback(const std_msgs::Float64::ConstPtr &msg) {
  ++samples;
  const int level = static_cast<int>(msg->data);
  if (level < -3)
    ++negatives;
  if (samples % 5 == 0)
    output_pub.publish(msg);
  if (negatives >= 4) {
    negatives = 0;
    std_msgs::Int32 out;
    out.data = level;
    if (6 < samples)
      out.data += 1000;
    level_pub.publish(out);
  }
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "const_integers");
  ros::NodeHandle nh;
  output_pub = nh.advertise<std_msgs::Float64>("output", 1000);
  level_pub = nh.advertise<std_msgs::Int32>("level", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, inputCallback);
  ros::spin();
  return 0;
}
