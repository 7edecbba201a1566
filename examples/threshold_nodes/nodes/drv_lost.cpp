// Thresholds mixed with values that are not constant.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Mixed {
public:
  Mixed() {
    nh_.param("gain", gain_, 0.5);
    nh_.param("bias", bias_, 1.0);
    nh_.param("base", base_, 2.0);
    nh_.param("extra", extra_, 3.0);
    nh_.param("decay", decay_, 0.9);
    sum_ = base_ + extra_;
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Mixed::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    const double value = msg->data;
    std_msgs::Float64 out;
    out.data = value;
    if (value > gain_ * previous_)
      out.data += 100;
    if (value < previous_ - bias_)
      out.data += 200;
    if (std::fabs(value) > sum_)
      out.data += 400;
    level_ *= decay_;
    if (value > level_) {
      level_ = value;
      out.data += 800;
    }
    previous_ = value;
    pub_.publish(out);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double gain_, bias_, base_, extra_, decay_, sum_;
  double previous_ = 0.0;
  double level_ = 1.0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "drv_lost");
  Mixed mixed;
  ros::spin();
}
