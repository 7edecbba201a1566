// The twin of drv_affine: derived thresholds that decide nothing published.
#include <cmath>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Statistics {
public:
  explicit Statistics(ros::NodeHandle nh) {
    nh.param("height_cm", height_, 300.0);
    height_ /= 100.0;
    slope_ = nh.param("slope_deg", 30.0) * M_PI / 180.0;
    const double radius = nh.param("radius", 2.0);
    radius_sq_ = radius * radius;
    scale_ = 0.1 * nh.param("scale", 5.0);
    pub_ = nh.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh.subscribe("input", 1000, &Statistics::onInput, this);
  }
  void print() const { ROS_INFO("%d %d %d", tall_, steep_, close_); }

private:
  void onInput(const std_msgs::Float64 &msg) {
    if (msg.data > height_)
      ++tall_;
    if (std::atan(msg.data) > slope_)
      ++steep_;
    close_ += msg.data * msg.data < radius_sq_ ? 1 : 0;
    std_msgs::Float64 out;
    out.data = scale_ * msg.data;
    pub_.publish(out);
  }

  ros::Publisher pub_;
  ros::Subscriber sub_;
  double height_, slope_, radius_sq_, scale_;
  int tall_ = 0, steep_ = 0, close_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "drv_cut");
  Statistics statistics{ros::NodeHandle()};
  ros::spin();
  statistics.print();
  return 0;
}
