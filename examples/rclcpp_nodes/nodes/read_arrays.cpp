// Parameters that are lists: by element, by size, in a loop, as texts.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("read_arrays") {
    limits_ = declare_parameter<std::vector<double>>("limits", {-3.0, 5.0});
    declare_parameter<std::vector<double>>("far", {8.0});
    far_ = get_parameter("far").as_double_array()[0];
    declare_parameter("steps", std::vector<int64_t>{1, 3, 6});
    get_parameter("steps", steps_);
    declare_parameter("modes", std::vector<std::string>{"slow", "fast"});
    const auto modes = get_parameter("modes").as_string_array();
    for (const auto &mode : modes)
      if (mode == "fast")
        fast_ = true;
    flags_ = declare_parameter("flags", std::vector<bool>{true, false});
    noted_ = declare_parameter("noted", std::vector<double>{4.0});
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    if (limits_.size() == 2 && msg.data < limits_[0])
      pub_->publish(msg);
    if (msg.data > limits_.at(1))
      pub_->publish(msg);
    if (msg.data > far_)
      pub_->publish(msg);
    for (const int64_t step : steps_)
      if (static_cast<int64_t>(msg.data) == step)
        pub_->publish(msg);
    if (fast_)
      pub_->publish(msg);
    if (flags_[0])
      pub_->publish(msg);
    if (msg.data > noted_.front())
      RCLCPP_DEBUG(get_logger(), "noted");
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  std::vector<double> limits_, noted_;
  std::vector<int64_t> steps_;
  std::vector<bool> flags_;
  double far_;
  bool fast_ = false;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
