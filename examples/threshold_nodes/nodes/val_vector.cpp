// A vector of thresholds: push_back, index, range-for and iterator.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>
#include <vector>

class Levels {
public:
  explicit Levels(ros::NodeHandle &nh) {
    up_.push_back(nh.param("first", 1.0));
    double second;
    nh.param("second", second, 4.0);
    up_.push_back(second);

    down_.resize(2);
    nh.param("shallow", down_[0], -1.0);
    nh.param("deep", down_[1], -6.0);
    index_pub_ = nh.advertise<std_msgs::Int32>("index", 1000);
    level_pub_ = nh.advertise<std_msgs::Int32>("level", 1000);
    below_pub_ = nh.advertise<std_msgs::Float64>("below", 1000);
    sub_ = nh.subscribe("input", 1000, &Levels::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    std_msgs::Int32 index;
    for (size_t i = 0; i < up_.size(); ++i) {
      if (msg->data < up_[i])
        break;
      index.data = i + 1;
    }
    index_pub_.publish(index);

    std_msgs::Int32 level;
    for (double threshold : up_)
      level.data += msg->data >= threshold ? 10 : 1;
    level_pub_.publish(level);

    for (auto it = down_.begin(); it != down_.end(); ++it)
      if (msg->data <= *it)
        below_pub_.publish(msg);
  }

  std::vector<double> up_;
  std::vector<double> down_;
  ros::Publisher index_pub_, level_pub_, below_pub_;
  ros::Subscriber sub_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_vector");
  ros::NodeHandle nh;
  Levels levels(nh);
  ros::spin();
  return 0;
}
