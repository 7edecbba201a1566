// What the comparisons decide is overwritten, or used by nobody, before
// anything is published.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/String.h>

class Reporter {
public:
  Reporter() {
    nh_.param("high", high_, 4.0);
    nh_.param("offset_above", offset_above_, 2.0);
    nh_.param("enabled", enabled_, true);
    pub_ = nh_.advertise<std_msgs::String>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Reporter::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    std_msgs::String out;
    if (msg->data > high_)
      out.data = "high";
    else
      out.data = "normal";
    out.data = "received";

    double offset = 0.0;
    if (msg->data > offset_above_)
      offset = 1.0;
    correct(offset);

    bool active = false;
    if (enabled_)
      active = true;
    active_ = active;
    pub_.publish(out);
  }

  void correct(double offset) { corrected_ += offset; }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double high_, offset_above_;
  double corrected_ = 0.0;
  bool enabled_;
  bool active_ = false;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_overwritten_result");
  Reporter reporter;
  ros::spin();
}
