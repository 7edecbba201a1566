// Negative: what the comparisons decide is only logged or counted.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("cmp_log_only") {
    limit_ = declare_parameter("limit", 5.0);
    low_ = declare_parameter("low", -3.0);
    verbose_ = declare_parameter("verbose", true);
    mode_ = declare_parameter("mode", std::string("high"));
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    if (msg.data > limit_)
      RCLCPP_WARN(get_logger(), "too high: %f", msg.data);
    if (msg.data < low_)
      RCLCPP_INFO_STREAM(get_logger(), "too low: " << msg.data);
    if (verbose_)
      RCLCPP_DEBUG_THROTTLE(get_logger(), *get_clock(), 1000, "%f", msg.data);
    if (mode_ == "high")
      ++count_;
    pub_->publish(msg);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_, low_;
  bool verbose_;
  std::string mode_;
  int count_ = 0;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
