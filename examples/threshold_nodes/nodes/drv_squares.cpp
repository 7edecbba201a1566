// Distances compared by their squares, and a variance by its root.
#include <cmath>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

template <typename T> static T squared(T x) { return x * x; }

class Proximity {
public:
  explicit Proximity(ros::NodeHandle nh) {
    double radius = nh.param("radius", 4.0);
    nh.param("near", near_, 2.0);
    nh.param("far", far_, 9.0);
    double variance;
    nh.param("variance", variance, 16.0);
    radius_sq_ = radius * radius;
    deviation_ = std::sqrt(variance);
    pub_ = nh.advertise<std_msgs::Float64>("output", 1000);
    sq_pub_ = nh.advertise<std_msgs::Float64>("squares", 1000);
    sub_ = nh.subscribe("input", 1000, &Proximity::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64 &msg) {
    std_msgs::Float64 sq;
    sq.data = squared(msg.data);
    if (sq.data < radius_sq_)
      sq_pub_.publish(sq);
    if (sq.data < std::pow(near_, 2))
      return;
    if (sq.data > squared(far_))
      return;
    if (std::fabs(msg.data - mean_) > deviation_)
      return;
    mean_ = 0.5 * mean_ + 0.5 * msg.data;
    pub_.publish(msg);
  }

  ros::Publisher pub_, sq_pub_;
  ros::Subscriber sub_;
  double radius_sq_, near_, far_, deviation_;
  double mean_ = 0.0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "drv_squares");
  Proximity proximity{ros::NodeHandle()};
  ros::spin();
}
