// Two structs with the same field name: one is configured, one is fixed.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

struct InputLimits {
  double min = -9.0;
  double max = 9.0;
};

struct OutputLimits {
  double min = -9.0;
  double max = 9.0;
};

class Scaler {
public:
  Scaler() {
    nh_.param("max", in_.max, 5.0);
    out_.min = -7.5;
    out_.max = 7.5;
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Scaler::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64 &msg) {
    if (msg.data > in_.max)
      return;
    if (msg.data < in_.min)
      return;
    std_msgs::Float64 scaled;
    scaled.data = 2 * msg.data;
    if (scaled.data > out_.max)
      scaled.data = out_.max;
    if (scaled.data < out_.min)
      scaled.data = out_.min;
    pub_.publish(scaled);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  InputLimits in_;
  OutputLimits out_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_same_field_name");
  Scaler scaler;
  ros::spin();
  return 0;
}
