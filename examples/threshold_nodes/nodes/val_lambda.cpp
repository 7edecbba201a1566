// Thresholds captured by lambdas: by value, by reference, by an init capture,
// through this, and handed to a generic lambda.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Splitter {
public:
  Splitter() {
    double upper = nh_.param("upper", 4.0);
    double lower = -4.0;
    nh_.getParam("lower", lower);
    nh_.param("center", center_, 0.5);
    int keep = nh_.param("keep", 3);

    auto beyond = [](auto value, auto limit) { return value > limit; };
    const double far = nh_.param("far", 8.0);

    high_pub_ = nh_.advertise<std_msgs::Float64>("high", 1000);
    low_pub_ = nh_.advertise<std_msgs::Float64>("low", 1000);
    mid_pub_ = nh_.advertise<std_msgs::Float64>("mid", 1000);

    high_sub_ = nh_.subscribe<std_msgs::Float64>(
        "input", 1000,
        [this, upper, far, beyond](const std_msgs::Float64::ConstPtr &m) {
          if (m->data > upper && !beyond(m->data, far))
            high_pub_.publish(m);
        });
    low_sub_ = nh_.subscribe<std_msgs::Float64>(
        "input", 1000,
        [this, limit = lower](const std_msgs::Float64::ConstPtr &m) {
          if (m->data < limit)
            low_pub_.publish(m);
        });
    mid_sub_ = nh_.subscribe<std_msgs::Float64>(
        "input", 1000,
        [this, n = 0, keep](const std_msgs::Float64::ConstPtr &m) mutable {
          if (std::fabs(m->data) < center_)
            return;
          auto advance = [&n, &keep] { return ++n == keep; };
          if (!advance())
            return;
          n = 0;
          mid_pub_.publish(m);
        });
  }

private:
  ros::NodeHandle nh_;
  ros::Publisher high_pub_, low_pub_, mid_pub_;
  ros::Subscriber high_sub_, low_sub_, mid_sub_;
  double center_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_lambda");
  Splitter splitter;
  ros::spin();
  return 0;
}
