// Thresholds that pass through casts: those that keep the value, and those
// that cut off the fraction.
#include <cstdint>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/UInt8.h>

class Camera {
public:
  Camera() {
    int brightness, quality;
    double exposure, rate;
    nh_.param("min_brightness", brightness, 100);
    nh_.param("max_quality", quality, 4);
    nh_.param("exposure", exposure, -4.7);
    nh_.param("rate", rate, 2.9);
    min_brightness_ = static_cast<unsigned char>(brightness);
    max_quality_ = quality;
    exposure_ = static_cast<float>(exposure);
    rate_ = static_cast<int>(rate);
    pub_ = nh_.advertise<std_msgs::UInt8>("brightness", 1000);
    raw_pub_ = nh_.advertise<std_msgs::Float64>("raw", 1000);
    sub_ = nh_.subscribe("input", 1000, &Camera::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    std_msgs::UInt8 out;
    out.data = static_cast<uint8_t>(128 + 12 * msg->data);
    if (out.data < min_brightness_)
      return;
    if (++frames_ >= rate_) {
      frames_ = 0;
      pub_.publish(out);
    }
    if (msg->data > max_quality_)
      raw_pub_.publish(msg);
    else if (static_cast<float>(msg->data) < exposure_)
      raw_pub_.publish(msg);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_, raw_pub_;
  ros::Subscriber sub_;
  unsigned char min_brightness_;
  double max_quality_;
  float exposure_;
  long rate_;
  long frames_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_casts");
  Camera camera;
  ros::spin();
}
