// Thresholds that are scaled, shifted, both, and negated with constants.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>

class Units {
public:
  Units() {
    double cm, celsius, percent, margin;
    nh_.param("height_cm", cm, 300.0);
    nh_.param("celsius", celsius, -16.0);
    nh_.param("percent", percent, 50.0);
    nh_.param("margin", margin, 2.0);
    nh_.param("band", band_, 5.0);
    nh_.param("half_count", half_count_, 2);
    height_ = cm / 100.0;
    fahrenheit_ = celsius * 1.8 + 32.0;
    fraction_ = 0.01 * percent;
    inner_ = 10.0 - margin;
    output_pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    code_pub_ = nh_.advertise<std_msgs::Int32>("code", 1000);
    sub_ = nh_.subscribe("input", 1000, &Units::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    const double value = msg->data;
    std_msgs::Int32 code;
    if (value > height_)
      code.data += 1;
    if (value < fahrenheit_)
      code.data += 2;
    if (std::fabs(value) / 10.0 > fraction_)
      code.data += 4;
    if (value >= inner_)
      code.data += 8;
    if (value < -band_)
      code.data += 16;
    code_pub_.publish(code);
    if (++count_ >= 2 * half_count_ + 1) {
      count_ = 0;
      output_pub_.publish(msg);
    }
  }

  ros::NodeHandle nh_;
  ros::Publisher output_pub_, code_pub_;
  ros::Subscriber sub_;
  double height_, fahrenheit_, fraction_, inner_, band_;
  int half_count_;
  int count_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "drv_affine");
  Units units;
  ros::spin();
  return 0;
}
