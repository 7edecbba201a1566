// Negative: what stands behind the thresholds shows itself elsewhere, but not
// by an exposing statement: setParam, std::cout, a file, the log.
#include <fstream>
#include <iostream>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Recorder {
public:
  Recorder() : pnh_("~"), file_("/dev/null") {
    pnh_.param("store_above", store_above_, 6.0);
    pnh_.param("print_above", print_above_, 3.0);
    pnh_.param("write_below", write_below_, -3.0);
    pnh_.param("error_below", error_below_, -9.0);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Recorder::record, this);
  }

private:
  void record(const std_msgs::Float64::ConstPtr &msg) {
    pub_.publish(msg);
    if (msg->data > store_above_)
      pnh_.setParam("last_peak", msg->data);
    if (msg->data > print_above_)
      std::cout << msg->data << '\n';
    if (msg->data < write_below_)
      file_ << msg->data << '\n';
    if (msg->data < error_below_)
      ROS_ERROR_STREAM("value " << msg->data << ", " << pub_.getNumSubscribers()
                                << " listen");
  }

  ros::NodeHandle nh_;
  ros::NodeHandle pnh_;
  std::ofstream file_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double store_above_, print_above_, write_below_, error_below_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_not_exposing");
  Recorder recorder;
  ros::spin();
  return 0;
}
