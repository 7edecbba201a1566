// The throw that a threshold guards stands in a called function; the caller
// publishes behind the call or in its handler.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/String.h>
#include <stdexcept>

namespace {

double max_load = 5.5;
ros::Publisher load_pub;
ros::Publisher fault_pub;

void requireLoad(double load) {
  if (load > max_load)
    throw std::runtime_error("overload");
}

void loadCallback(const std_msgs::Float64::ConstPtr &msg) {
  try {
    requireLoad(msg->data);
    load_pub.publish(msg);
  } catch (const std::runtime_error &error) {
    std_msgs::String fault;
    fault.data = error.what();
    fault_pub.publish(fault);
  }
}

} // namespace

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_exception_callee");
  ros::NodeHandle nh;
  ros::param::get("max_load", max_load);
  load_pub = nh.advertise<std_msgs::Float64>("output", 1000);
  fault_pub = nh.advertise<std_msgs::String>("faults", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, loadCallback);
  ros::spin();
  return 0;
}
