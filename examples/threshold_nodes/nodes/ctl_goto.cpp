// goto: one over the publish, decided by a threshold, and one back to it,
// bounded by a parameter.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>

static double reject_above;
static int max_tries;
static ros::Publisher accepted_pub;
static ros::Publisher tries_pub;

static void cb(const std_msgs::Float64 &msg) {
  std_msgs::Int32 tries;
  tries.data = 0;

  if (msg.data > reject_above)
    goto rejected;
  accepted_pub.publish(msg);
  return;

rejected:
  if (tries.data >= max_tries)
    goto done;
  ++tries.data;
  tries_pub.publish(tries);
  goto rejected;

done:
  ROS_DEBUG("rejected %f", msg.data);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_goto");
  ros::NodeHandle nh;
  nh.param("reject_above", reject_above, 2.0);
  nh.param("max_tries", max_tries, 2);
  accepted_pub = nh.advertise<std_msgs::Float64>("output", 1000);
  tries_pub = nh.advertise<std_msgs::Int32>("tries", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, cb);
  ros::spin();
}
