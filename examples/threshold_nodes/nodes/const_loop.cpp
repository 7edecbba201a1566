// Loops over constant bounds that publish, and one that does not.
#include <array>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

static constexpr int kCopies = 3;

class Repeater {
public:
  Repeater() {
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    countdown_pub_ = nh_.advertise<std_msgs::Float64>("countdown", 1000);
    sub_ = nh_.subscribe("input", 1000, &Repeater::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    for (int i = 0; i < kCopies; ++i)
      pub_.publish(msg);

    std_msgs::Float64 out;
    out.data = msg->data;
    while (out.data > 1.5) {
      out.data -= 2.0;
      countdown_pub_.publish(out);
    }

    for (std::size_t i = 0; i < 4; ++i)
      history_[i] = 0.5 * history_[i] + msg->data;
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_, countdown_pub_;
  ros::Subscriber sub_;
  std::array<double, 4> history_{};
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "const_loop");
  Repeater repeater;
  ros::spin();
}
