// The publishers stand in a vector and in a map; thresholds choose the index,
// the key, or whether is published.
#include <map>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <string>
#include <vector>

class Sorter {
public:
  Sorter() {
    nh_.param("sorter/first_edge", first_edge_, -3.0);
    nh_.param("sorter/second_edge", second_edge_, 3.0);
    nh_.param("sorter/reject", reject_, 9.0);
    for (const char *name : {"bin0", "bin1", "bin2"})
      bins_.push_back(nh_.advertise<std_msgs::Float64>(name, 1000));
    for (const char *name : {"accepted", "rejected"})
      by_name_[name] = nh_.advertise<std_msgs::Float64>(name, 1000);
    sub_ = nh_.subscribe("input", 1000, &Sorter::sort, this);
  }

private:
  void sort(const std_msgs::Float64::ConstPtr &msg) {
    std::size_t bin = 0;
    if (msg->data > first_edge_)
      bin = 1;
    if (msg->data > second_edge_)
      bin = 2;
    bins_[bin].publish(msg);

    if (msg->data > reject_)
      by_name_.at("rejected").publish(msg);
    else
      by_name_["accepted"].publish(msg);
  }

  ros::NodeHandle nh_;
  std::vector<ros::Publisher> bins_;
  std::map<std::string, ros::Publisher> by_name_;
  ros::Subscriber sub_;
  double first_edge_, second_edge_, reject_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_publisher_containers");
  Sorter sorter;
  ros::spin();
  return 0;
}
