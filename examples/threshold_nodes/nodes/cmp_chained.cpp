// Conditions of several comparisons, mixed with operands that are none.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Lander {
public:
  Lander() {
    nh_.param("max_speed", max_speed_, 6.0);
    nh_.param("min_height", min_height_, -6.0);
    nh_.param("settle", settle_, 2);
    nh_.param("tilt", tilt_, 4.0);
    nh_.param("override", override_, false);
    nh_.param("patience", patience_, 6);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    abort_pub_ = nh_.advertise<std_msgs::Float64>("abort", 1000);
    sub_ = nh_.subscribe("input", 1000, &Lander::callback, this);
  }

private:
  bool rising(double value) const { return value > last_; }

  void callback(const std_msgs::Float64ConstPtr &msg) {
    const double v = msg->data;
    ++samples_;
    if (v < max_speed_ && v > min_height_ && samples_ >= settle_ && rising(v))
      pub_.publish(msg);
    if ((std::fabs(v - last_) > tilt_ && !rising(v)) || override_ ||
        waited_ == patience_) {
      abort_pub_.publish(msg);
      waited_ = 0;
    } else {
      ++waited_;
    }
    last_ = v;
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_, abort_pub_;
  ros::Subscriber sub_;
  double max_speed_, min_height_, tilt_;
  int settle_, patience_;
  bool override_;
  double last_ = 0.0;
  int samples_ = 0;
  int waited_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "cmp_chained");
  Lander lander;
  ros::spin();
  return 0;
}
