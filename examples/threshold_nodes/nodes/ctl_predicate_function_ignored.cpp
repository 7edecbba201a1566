// Negative twin of ctl_predicate_function: the results of the bool functions
// are dropped or only logged.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/String.h>

namespace {
bool isAbove(double value, double limit) { return value > limit; }
} // namespace

class Classifier {
public:
  Classifier() {
    ros::param::param("~peak", peak_, 7.5);
    ros::param::param("~band_low", band_low_, -3.0);
    ros::param::param("~band_high", band_high_, 3.0);
    pub_ = nh_.advertise<std_msgs::String>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Classifier::classify, this);
  }

private:
  bool inBand(double value) const {
    if (value < band_low_)
      return false;
    if (value > band_high_)
      return false;
    return true;
  }

  void classify(const std_msgs::Float64::ConstPtr &msg) {
    isAbove(msg->data, peak_);
    if (inBand(msg->data))
      ROS_INFO_STREAM(msg->data << " is in the band");

    std_msgs::String text;
    text.data = msg->data < 0 ? "negative" : "positive";
    pub_.publish(text);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double peak_, band_low_, band_high_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_predicate_function_ignored");
  Classifier classifier;
  ros::spin();
  return 0;
}
