// A parameter found with searchParam in a namespace above, as costmap_2d and
// move_base do for the footprint.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <string>

class Footprint {
public:
  Footprint() : pnh_("~") {
    std::string key;
    if (pnh_.searchParam("inflation_limit", key))
      pnh_.param(key, inflation_, 2.5);
    std::string padding_key("padding_limit");
    pnh_.searchParam("padding_limit", padding_key);
    padding_ = nh_.param(padding_key, -2.5);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Footprint::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    if (msg->data > inflation_)
      pub_.publish(*msg);
    if (msg->data < padding_)
      pub_.publish(*msg);
  }

  ros::NodeHandle nh_, pnh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double inflation_ = 2.5;
  double padding_ = 0.0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "read_search_param");
  Footprint footprint;
  ros::spin();
}
