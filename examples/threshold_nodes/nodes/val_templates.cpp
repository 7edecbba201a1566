// A class template and a function template, instantiated for several types
// and parameters: one comparison in the source each.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>

template <typename T> class Deadband {
public:
  Deadband(const ros::NodeHandle &nh, const std::string &name, T fallback) {
    nh.param(name, width_, fallback);
  }

  bool leaves(T value) {
    const T distance = value > center_ ? value - center_ : center_ - value;
    if (distance <= width_)
      return false;
    center_ = value;
    return true;
  }

private:
  T width_;
  T center_{};
};

template <typename Message, typename Limit>
void publishUpTo(ros::Publisher &pub, const Message &message, Limit limit) {
  if (message.data <= limit)
    pub.publish(message);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_templates");
  ros::NodeHandle nh;
  Deadband<double> fine(nh, "fine_width", 0.5);
  Deadband<int> coarse(nh, "coarse_width", 3);
  const double ceiling = nh.param("ceiling", 7.5);
  const int int_ceiling = nh.param("int_ceiling", 8);

  auto fine_pub = nh.advertise<std_msgs::Float64>("fine", 1000);
  auto coarse_pub = nh.advertise<std_msgs::Int32>("coarse", 1000);
  auto sub = nh.subscribe<std_msgs::Float64>(
      "input", 1000, [&](const std_msgs::Float64::ConstPtr &msg) {
        if (fine.leaves(msg->data))
          publishUpTo(fine_pub, *msg, ceiling);
        std_msgs::Int32 rounded;
        rounded.data = static_cast<int>(msg->data);
        if (coarse.leaves(rounded.data))
          publishUpTo(coarse_pub, rounded, int_ceiling);
      });
  ros::spin();
  return 0;
}
