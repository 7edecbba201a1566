// One parameter on its way through several functions and members, each adding
// a piece of arithmetic.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Adc {
public:
  void setLimit(double volts) { limit_ = toCounts(volts); }
  double limit() const { return limit_ + kOffset; }
  bool saturated(double counts) const { return counts >= limit(); }

private:
  static constexpr double kOffset = 512.0;
  static double toCounts(double volts) { return volts * 204.75; }
  double limit_ = 0.0;
};

static double millivoltsToVolts(double millivolts) { return millivolts / 1000; }

static Adc adc;

static void configure(int millivolts) {
  adc.setLimit(millivoltsToVolts(millivolts));
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "drv_chain");
  ros::NodeHandle nh("~");
  int millivolts = 1500;
  nh.getParam("limit_mv", millivolts);
  configure(millivolts);

  ros::NodeHandle topics;
  auto pub = topics.advertise<std_msgs::Float64>("output", 1000);
  auto sub = topics.subscribe<std_msgs::Float64>(
      "input", 1000, [&pub](const std_msgs::Float64::ConstPtr &msg) {
        const double counts = 512.0 + 204.75 * msg->data / 2;
        if (adc.saturated(counts))
          return;
        std_msgs::Float64 out;
        out.data = counts;
        pub.publish(out);
      });
  ros::spin();
  return 0;
}
