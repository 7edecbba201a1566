// A node in several files: the parameters are read in one function into a
// struct, compared in another class, and its state decides the publish here.
#include "battery.h"

#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/String.h>

namespace {

class BatteryNode {
public:
  BatteryNode() : battery_(readLimits(ros::NodeHandle("battery"))) {
    nh_.param("verbose", verbose_, false);
    pub_ = nh_.advertise<std_msgs::String>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &BatteryNode::onVoltage, this);
  }

private:
  void onVoltage(const std_msgs::Float64::ConstPtr &voltage) {
    battery_.update(voltage->data);
    if (verbose_)
      ROS_INFO("voltage %f", voltage->data);

    std_msgs::String text;
    switch (battery_.state()) {
    case BatteryState::Good:
      return;
    case BatteryState::Low:
      text.data = "low";
      break;
    case BatteryState::Critical:
      text.data = "critical";
      break;
    }
    pub_.publish(text);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  Battery battery_;
  bool verbose_;
};

} // namespace

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_several_files");
  BatteryNode node;
  ros::spin();
  return 0;
}
