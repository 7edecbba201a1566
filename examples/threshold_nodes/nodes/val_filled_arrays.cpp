// Bytes that memset fills, with a length that is only known at run time.
#include <cstring>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <vector>

class Cells {
public:
  explicit Cells(ros::NodeHandle &nh) {
    bool occupied;
    int count;
    nh.param("count", count, 8);
    nh.param("occupied", occupied, true);
    nh.param("shown", shown_, false);
    cells_.resize(count);
    seen_.resize(count);
    std::memset(cells_.data(), occupied ? 9 : 1, count);
    std::memset(seen_.data(), shown_ ? 2 : 0, count);
    pub_ = nh.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh.subscribe("input", 1000, &Cells::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    if (msg->data < cells_[3])
      pub_.publish(msg);
    ROS_DEBUG("%d", seen_[3]);
  }

  bool shown_;
  std::vector<unsigned char> cells_, seen_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_filled_arrays");
  ros::NodeHandle nh;
  Cells cells(nh);
  ros::spin();
  return 0;
}
