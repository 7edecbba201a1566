// The comparisons stand in a class template in a header of the package, which
// is used for two types; what one filter rejected is compared in the node.
#include <cmath>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>
#include <threshold_nodes/band_filter.h>

using threshold_nodes::BandFilter;

class FilterNode {
public:
  FilterNode(ros::NodeHandle nh, ros::NodeHandle pnh)
      : real_(pnh.param("real_low", -5.0), pnh.param("real_high", 5.0)),
        whole_(pnh.param("whole_low", 0), pnh.param("whole_high", 3)),
        max_rejected_(pnh.param("max_rejected", 30)) {
    real_pub_ = nh.advertise<std_msgs::Float64>("output", 1000);
    whole_pub_ = nh.advertise<std_msgs::Int32>("whole", 1000);
    sub_ = nh.subscribe("input", 1000, &FilterNode::input, this);
  }

private:
  void input(const std_msgs::Float64::ConstPtr &msg) {
    if (real_.pass(msg->data))
      real_pub_.publish(msg);

    std_msgs::Int32 whole;
    whole.data = static_cast<int>(std::floor(msg->data));
    if (whole_.pass(whole.data))
      whole_pub_.publish(whole);
    else if (whole_.rejected() > max_rejected_)
      whole_pub_.publish(std_msgs::Int32());
  }

  BandFilter<double> real_;
  BandFilter<int> whole_;
  unsigned max_rejected_;
  ros::Publisher real_pub_, whole_pub_;
  ros::Subscriber sub_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_header_filter");
  FilterNode node{ros::NodeHandle(), ros::NodeHandle("~")};
  ros::spin();
  return 0;
}
