#include <nodelet/nodelet.h>
#include <plugged_limits/limit.h>
#include <pluginlib/class_list_macros.hpp>
#include <std_msgs/Float64.h>

namespace plugged {
class Alarm : public nodelet::Nodelet {
  void onInit() override {
    level_.read(getPrivateNodeHandle(), "alarm_level", 5.0);
    publisher_ = getPrivateNodeHandle().advertise<std_msgs::Float64>("alarm", 1);
    subscriber_ = getPrivateNodeHandle().subscribe("in", 1, &Alarm::hear, this);
  }
  void hear(const std_msgs::Float64::ConstPtr &message) {
    if (level_.isPassedBy(message->data))
      publisher_.publish(message);
  }
  Limit level_;
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
};
} // namespace plugged
PLUGINLIB_EXPORT_CLASS(plugged::Alarm, nodelet::Nodelet)
