// Thresholds in a std::array and in a std::map from names to values.
#include <array>
#include <map>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>
#include <string>

std::map<std::string, double> load(const ros::NodeHandle &nh) {
  std::map<std::string, double> limits;
  limits["left"] = nh.param("left_limit", 3.0);
  double right;
  nh.param("right_limit", right, 6.0);
  limits.emplace("right", right);
  return limits;
}

class Axes {
public:
  explicit Axes(ros::NodeHandle &nh) : limits_(load(nh)) {
    nh.param("inner", steps_[0], 1.0);
    nh.param("middle", steps_.at(1), 4.0);
    steps_[2] = nh.param("outer", 8.0);
    step_pub_ = nh.advertise<std_msgs::Int32>("step", 1000);
    side_pub_ = nh.advertise<std_msgs::Float64>("side", 1000);
    any_pub_ = nh.advertise<std_msgs::Float64>("any", 1000);
    sub_ = nh.subscribe("input", 1000, &Axes::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64 &msg) {
    const double size = std::fabs(msg.data);
    std_msgs::Int32 step;
    while (step.data < 3 && size > steps_[step.data])
      ++step.data;
    step_pub_.publish(step);

    const std::string side = msg.data < 0 ? "left" : "right";
    if (size > limits_.at(side))
      side_pub_.publish(msg);

    for (const auto &entry : limits_)
      if (size < entry.second)
        any_pub_.publish(msg);
  }

  std::map<std::string, double> limits_;
  std::array<double, 3> steps_;
  ros::Publisher step_pub_, side_pub_, any_pub_;
  ros::Subscriber sub_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_array_map");
  ros::NodeHandle nh;
  Axes axes(nh);
  ros::spin();
  return 0;
}
