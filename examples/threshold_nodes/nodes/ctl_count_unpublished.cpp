// Negative twin of ctl_count_then_publish: the count of spikes ends in a
// warning, what is published is the total.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>

class SpikeCounter {
public:
  SpikeCounter() : private_nh_("~") {
    private_nh_.param("spike_limit", spike_limit_, 3.0);
    private_nh_.param("spikes_to_report", spikes_to_report_, 4);
    pub_ = nh_.advertise<std_msgs::Int32>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &SpikeCounter::callback, this);
  }

  void callback(const std_msgs::Float64::ConstPtr &msg) {
    ++total_;
    if (msg->data > spike_limit_)
      ++spikes_;
    if (spikes_ >= spikes_to_report_) {
      ROS_WARN_STREAM(spikes_ << " spikes in " << total_ << " values");
      spikes_ = 0;
    }
    std_msgs::Int32 report;
    report.data = total_;
    pub_.publish(report);
  }

private:
  ros::NodeHandle nh_;
  ros::NodeHandle private_nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double spike_limit_;
  int spikes_to_report_;
  int spikes_ = 0;
  int total_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_count_unpublished");
  SpikeCounter counter;
  ros::spin();
  return 0;
}
