// dynamic_reconfigure: the whole config is kept and its fields are used later.
#include <boost/bind/bind.hpp>
#include <dynamic_reconfigure/server.h>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <threshold_nodes/TrackerConfig.h>

static threshold_nodes::TrackerConfig g_config;
static int g_ignored = 0;

static void reconfigureCallback(threshold_nodes::TrackerConfig &config,
                                uint32_t) {
  g_config = config;
}

static void inputCallback(const std_msgs::Float64::ConstPtr &msg,
                          ros::Publisher &pub) {
  threshold_nodes::TrackerConfig config = g_config;
  if (msg->data < config.gate) {
    pub.publish(*msg);
    return;
  }
  if (msg->data > config.lost_distance)
    ++g_ignored;
  std_msgs::Float64 out;
  switch (config.mode) {
  case threshold_nodes::Tracker_Hold:
    out.data = config.gate;
    break;
  case threshold_nodes::Tracker_Zero:
    out.data = 0.0;
    break;
  default:
    return;
  }
  pub.publish(out);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "read_reconfigure_copy");
  ros::NodeHandle nh;
  dynamic_reconfigure::Server<threshold_nodes::TrackerConfig> server;
  server.setCallback(reconfigureCallback);

  ros::Publisher pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe<std_msgs::Float64>(
      "input", 1000,
      boost::bind(inputCallback, boost::placeholders::_1, boost::ref(pub)));
  ros::spin();
  return 0;
}
