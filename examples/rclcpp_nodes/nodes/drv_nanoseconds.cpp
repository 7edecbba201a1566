// Nanoseconds and seconds of durations, and arithmetic of std::chrono.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("drv_nanoseconds") {
    timeout_ = declare_parameter("timeout", 5.0);
    limitNs_ = static_cast<int64_t>(declare_parameter("limit_s", 8.0) * 1e9);
    short_ = std::chrono::milliseconds(declare_parameter("short_ms", 2000));
    window_ = rclcpp::Duration::from_seconds(declare_parameter("window", 6.0));
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    const rclcpp::Duration age = rclcpp::Duration::from_seconds(msg.data);
    if (age.nanoseconds() > RCL_S_TO_NS(static_cast<int64_t>(timeout_)))
      pub_->publish(msg);
    if (age.nanoseconds() > limitNs_)
      pub_->publish(msg);
    if (age < short_)
      pub_->publish(msg);
    if (age.seconds() >= window_.seconds() / 2)
      pub_->publish(msg);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double timeout_;
  int64_t limitNs_;
  std::chrono::milliseconds short_;
  rclcpp::Duration window_{0, 0};
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
