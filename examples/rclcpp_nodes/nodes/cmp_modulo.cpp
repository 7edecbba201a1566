// Every n-th sample, and a phase.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("cmp_modulo") {
    every_ = declare_parameter("every", 2);
    rate_ = declare_parameter<int>("rate", 3);
    noted_ = declare_parameter("noted", 4);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    ++count_;
    if (count_ % every_ == 0)
      pub_->publish(msg);
    if (count_ % rate_ != 0)
      return;
    if (count_ % noted_ == 0)
      RCLCPP_DEBUG(get_logger(), "noted");
    pub_->publish(msg);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  int every_, rate_, noted_;
  int count_ = 0;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
