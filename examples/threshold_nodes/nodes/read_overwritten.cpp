// Parameters that are read and overwritten before the comparison.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Overwriter {
public:
  explicit Overwriter(ros::NodeHandle nh) {
    nh.param("low", low_, -1.0);
    low_ = -2.0;
    double high = 9.0;
    nh.param("high", high, 3.0);
    high = 4.0;
    high_ = high;
    nh.param("kept", kept_, 6.0);
    pub_ = nh.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh.subscribe("input", 1000, &Overwriter::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64 &msg) {
    double limit = kept_;
    limit = msg.data / 2;
    if (msg.data > high_)
      return;
    if (previous_ < limit)
      pub_.publish(msg);
    previous_ = msg.data;
  }

  ros::Publisher pub_;
  ros::Subscriber sub_;
  double low_, high_, kept_;
  double previous_ = 0.0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "read_overwritten");
  Overwriter overwriter{ros::NodeHandle()};
  ros::spin();
}
