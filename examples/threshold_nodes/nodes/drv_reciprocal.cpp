// A rate in Hz compared as a period, and integers divided by constants.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>

class Sampler {
  double period_;
  int half_;
  int coarse_;
  int ticks_ = 0;
  double clock_ = 0.0;
  ros::Publisher pub_;
  ros::Publisher tick_pub_;
  ros::Subscriber sub_;

  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    clock_ += std::fabs(msg->data);
    if (clock_ >= period_) {
      clock_ = 0.0;
      pub_.publish(msg);
    }

    std_msgs::Int32 out;
    out.data = static_cast<int>(msg->data);
    if (out.data > half_)
      out.data = 100;
    if (++ticks_ < coarse_ / 4)
      return;
    ticks_ = 0;
    tick_pub_.publish(out);
  }

public:
  Sampler(ros::NodeHandle &nh, ros::NodeHandle &pnh) {
    double rate;
    pnh.param("rate", rate, 0.05);
    period_ = 1.0 / rate;
    int width;
    pnh.param("width", width, 7);
    half_ = width / 2;
    coarse_ = pnh.param("quarters", 9);
    pub_ = nh.advertise<std_msgs::Float64>("output", 1000);
    tick_pub_ = nh.advertise<std_msgs::Int32>("ticks", 1000);
    sub_ = nh.subscribe("input", 1000, &Sampler::onInput, this);
  }
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "drv_reciprocal");
  ros::NodeHandle nh;
  ros::NodeHandle pnh("~");
  Sampler sampler(nh, pnh);
  ros::spin();
  return 0;
}
