// Early return, continue and break in front of a publish, each decided by a
// threshold.
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
    const double amplitude = std::fabs(msg.data);
    if (amplitude < dead_zone_)
      return;

    for (double factor : kFactors) {
      const double scaled = factor * amplitude;
      if (scaled < smallest_)
        continue;
      if (scaled > largest_)
        break;
      std_msgs::Float64 out;
      out.data = scaled;
      pub_.publish(out);
    }
  }

  double dead_zone_;
  double smallest_;
  double largest_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
};

} // namespace

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_early_exit");
  Harmonics harmonics(ros::NodeHandle(), ros::NodeHandle("~"));
  ros::spin();
  return 0;
}
