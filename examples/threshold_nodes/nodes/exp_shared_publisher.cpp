// The publisher is held by a shared_ptr that several objects have.
#include <memory>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

using PublisherPtr = std::shared_ptr<ros::Publisher>;

class Filter {
public:
  Filter(PublisherPtr publisher, double limit)
      : publisher_(std::move(publisher)), limit_(limit) {}

  void apply(const std_msgs::Float64 &msg) const {
    if (msg.data < limit_)
      publisher_->publish(msg);
  }

private:
  PublisherPtr publisher_;
  double limit_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_shared_publisher");
  ros::NodeHandle nh;
  auto publisher = std::make_shared<ros::Publisher>(
      nh.advertise<std_msgs::Float64>("output", 1000));

  const Filter coarse(publisher, nh.param("coarse_limit", 0.0));
  const Filter fine(publisher, nh.param("fine_limit", -5.0));
  ros::Subscriber sub = nh.subscribe<std_msgs::Float64>(
      "input", 1000, [&](const std_msgs::Float64::ConstPtr &msg) {
        coarse.apply(*msg);
        fine.apply(*msg);
      });
  ros::spin();
  return 0;
}
