// Negative twin of ctl_early_exit: return, continue and break come after the
// publish and keep nothing but statistics from being updated.
#include <array>
#include <cmath>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

namespace {

const std::array<double, 4> kFactors{{0.5, 1.0, 2.0, 4.0}};

class Harmonics {
public:
  Harmonics(ros::NodeHandle nh, const ros::NodeHandle &pnh)
      : dead_zone_(pnh.param("dead_zone", 0.5)),
        smallest_(pnh.param("smallest", 1.0)),
        largest_(pnh.param("largest", 12.0)),
        pub_(nh.advertise<std_msgs::Float64>("output", 1000)),
        sub_(nh.subscribe("input", 1000, &Harmonics::onInput, this)) {}

private:
  void onInput(const std_msgs::Float64 &msg) {
    for (double factor : kFactors) {
      std_msgs::Float64 out;
      out.data = factor * msg.data;
      pub_.publish(out);
    }

    const double amplitude = std::fabs(msg.data);
    if (amplitude < dead_zone_)
      return;
    for (double factor : kFactors) {
      const double scaled = factor * amplitude;
      if (scaled < smallest_)
        continue;
      if (scaled > largest_)
        break;
      ++usable_;
    }
    ROS_DEBUG_STREAM("usable harmonics: " << usable_);
  }

  double dead_zone_;
  double smallest_;
  double largest_;
  int usable_ = 0;
  ros::Publisher pub_;
  ros::Subscriber sub_;
};

} // namespace

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_exit_after_publish");
  Harmonics harmonics(ros::NodeHandle(), ros::NodeHandle("~"));
  ros::spin();
  return 0;
}
