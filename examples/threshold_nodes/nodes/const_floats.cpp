// Hard-coded floating point numbers, literals and a product of literals.
#include <cmath>
#include <ros/ros.h>
#include <std_msgs/Float32.h>
#include <std_msgs/Float64.h>

class Deadzone {
public:
  Deadzone() {
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    float_pub_ = nh_.advertise<std_msgs::Float32>("float_output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Deadzone::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    std_msgs::Float64 out;
    out.data = msg->data;
    if (std::abs(out.data) < 0.5)
      out.data = 0.0;
    if (out.data > 2.5 * M_PI)
      out.data = 2.5 * M_PI;
    else if (-7.25 > out.data)
      return;
    pub_.publish(out);

    std_msgs::Float32 narrow;
    narrow.data = static_cast<float>(msg->data);
    if (narrow.data >= 1e-1f)
      float_pub_.publish(narrow);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_, float_pub_;
  ros::Subscriber sub_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "const_floats");
  Deadzone deadzone;
  ros::spin();
}
