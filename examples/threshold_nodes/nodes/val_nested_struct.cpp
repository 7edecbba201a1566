// Thresholds in nested structs that are copied as a whole, twice.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

struct Band {
  double low;
  double high;
};

struct Channel {
  Band warn;
  Band stop;
  int priority;
};

struct Settings {
  Channel left;
  Channel right;
};

class Watch {
public:
  void configure(const Settings &settings) { settings_ = settings; }

  double judge(double value) const {
    const Channel left = settings_.left;
    if (value > left.stop.high)
      return 3.0;
    if (value < left.warn.low)
      return -1.0;
    const Band &right = settings_.right.stop;
    if (value < right.high)
      return 0.5;
    return value;
  }

private:
  Settings settings_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_nested_struct");
  ros::NodeHandle nh("~");
  ros::NodeHandle topics;

  Settings s = {};
  nh.param("left/warn/low", s.left.warn.low, -3.0);
  nh.param("left/warn/high", s.left.warn.high, 3.0);
  nh.param("left/stop/high", s.left.stop.high, 6.0);
  nh.param("right/stop/high", s.right.stop.high, 1.0);
  Watch watch;
  watch.configure(s);

  ros::Publisher pub = topics.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = topics.subscribe<std_msgs::Float64>(
      "input", 1000, [&](const std_msgs::Float64::ConstPtr &msg) {
        std_msgs::Float64 out;
        out.data = watch.judge(msg->data);
        pub.publish(out);
      });
  ros::spin();
}
