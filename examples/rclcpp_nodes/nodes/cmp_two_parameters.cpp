// Two parameters meet in one comparison.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("cmp_two_parameters") {
    low_ = declare_parameter("low", -3.0);
    high_ = declare_parameter("high", 5.0);
    if (low_ > high_)
      RCLCPP_WARN(get_logger(), "low is above high");
    share_ = declare_parameter("share", 0.5);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    if (msg.data < low_ || msg.data > high_)
      pub_->publish(msg);
    if (msg.data > share_ * high_)
      pub_->publish(msg);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double low_, high_, share_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
