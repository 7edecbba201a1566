// String parameters: compared with texts and with each other, on both sides,
// by compare, by emptiness and by their beginning.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/String.h>
#include <string>

class Labeller {
public:
  Labeller() : pnh_("~") {
    pnh_.param<std::string>("mode", mode_, "sign");
    pnh_.param("watch", watch_, std::string("negative"));
    pnh_.getParam("unit", unit_);
    pnh_.param<std::string>("style", style_, "long");
    pnh_.param<std::string>("prefix", prefix_, "");
    pnh_.param<std::string>("frame", frame_, "base_link");
    pnh_.param<std::string>("log", log_, "none");
    pub_ = nh_.advertise<std_msgs::String>("output", 1000);
    watch_pub_ = nh_.advertise<std_msgs::Float64>("watched", 1000);
    sub_ = nh_.subscribe("input", 1000, &Labeller::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    std::string label = msg->data < 0 ? "negative" : "positive";
    if (label == watch_)
      watch_pub_.publish(msg);
    if (mode_ != "sign")
      label = "value";
    if ("m" == unit_)
      label += " m";
    if (style_.compare("long") == 0)
      label += " long";
    if (!prefix_.empty())
      label = prefix_ + label;
    if (frame_.find("base") == 0)
      label += "@base";
    if (log_ == "all")
      ROS_INFO("%s", label.c_str());
    std_msgs::String out;
    out.data = label;
    pub_.publish(out);
  }

  ros::NodeHandle nh_, pnh_;
  ros::Publisher pub_, watch_pub_;
  ros::Subscriber sub_;
  std::string mode_, watch_, style_, prefix_, frame_, log_;
  std::string unit_ = "m";
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "cmp_strings");
  Labeller labeller;
  ros::spin();
}
