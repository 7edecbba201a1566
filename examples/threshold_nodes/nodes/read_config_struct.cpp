// Parameters in a struct: one filled through a reference, one returned.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

namespace {

struct RangeConfig {
  double near_limit = 0.0;
  double far_limit = 0.0;
  bool invert = false;
};

struct RateConfig {
  int keep_every = 1;
  int drop_first = 2;
};

void loadRange(ros::NodeHandle &nh, RangeConfig &cfg) {
  nh.param("near_limit", cfg.near_limit, -3.0);
  nh.param("far_limit", cfg.far_limit, 8.0);
  nh.param("invert", cfg.invert, false);
}

RateConfig readRate(ros::NodeHandle &nh) {
  RateConfig cfg;
  cfg.keep_every = nh.param("keep_every", 2);
  nh.getParam("drop_first", cfg.drop_first);
  return cfg;
}

class RangeFilter {
public:
  RangeFilter(const RangeConfig &range, RateConfig rate)
      : range_(range), rate_(rate) {}

  bool accept(double value) {
    if (dropped_ < rate_.drop_first) {
      ++dropped_;
      return false;
    }
    const double v = range_.invert ? -value : value;
    if (v < range_.near_limit || v > range_.far_limit)
      return false;
    return ++seen_ % rate_.keep_every == 0;
  }

private:
  RangeConfig range_;
  RateConfig rate_;
  int seen_ = 0;
  int dropped_ = 0;
};

} // namespace

int main(int argc, char **argv) {
  ros::init(argc, argv, "read_config_struct");
  ros::NodeHandle nh;
  RangeConfig range;
  loadRange(nh, range);
  RangeFilter filter(range, readRate(nh));

  ros::Publisher pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe<std_msgs::Float64>(
      "input", 1000, [&](const std_msgs::Float64::ConstPtr &msg) {
        if (filter.accept(msg->data))
          pub.publish(msg);
      });
  ros::spin();
  return 0;
}
