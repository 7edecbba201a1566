// dynamic_reconfigure: fields that are text, compared in the callback and
// later.
#include <dynamic_reconfigure/server.h>
#include <ros/ros.h>
#include <std_msgs/String.h>
#include <threshold_nodes/LabelConfig.h>

class Labels {
public:
  Labels() {
    server_.setCallback([this](threshold_nodes::LabelConfig &config, uint32_t) {
      reconfigure(config);
    });
    pub_ = nh_.advertise<std_msgs::String>("output", 1000);
    sub_ = nh_.subscribe("text", 1000, &Labels::onLabel, this);
  }

private:
  void reconfigure(threshold_nodes::LabelConfig &config) {
    if (config.style == "loud")
      end_ = "!";
    if (config.prefix.empty())
      config.prefix = "-";
    prefix_ = config.prefix;
    if (config.note != "")
      ROS_INFO("%s", config.note.c_str());
    config_ = config;
  }

  void onLabel(const std_msgs::String::ConstPtr &msg) {
    if (msg->data == config_.stop)
      return;
    std_msgs::String out;
    out.data = prefix_ + msg->data + end_;
    pub_.publish(out);
  }

  ros::NodeHandle nh_;
  dynamic_reconfigure::Server<threshold_nodes::LabelConfig> server_;
  threshold_nodes::LabelConfig config_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  std::string prefix_, end_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "read_reconfigure_text");
  Labels labels;
  ros::spin();
  return 0;
}
