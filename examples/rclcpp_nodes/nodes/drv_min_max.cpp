// Bounds by std::min, std::max and std::clamp.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

#include <algorithm>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("drv_min_max") {
    ceiling_ = declare_parameter("ceiling", 5.0);
    floor_ = declare_parameter("floor", -3.0);
    left_ = declare_parameter("left", -4.0);
    right_ = declare_parameter("right", 4.0);
    limit_ = std::min(declare_parameter("limit", 9.0), 8.0);
    noted_ = declare_parameter("noted", 4.0);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    Float64 out;
    out.data = std::min(msg.data, ceiling_);
    out.data = std::max(floor_, out.data);
    pub_->publish(out);
    out.data = std::clamp(msg.data, left_, right_);
    pub_->publish(out);
    if (msg.data > limit_)
      pub_->publish(msg);
    const double bounded = std::min(msg.data, noted_);
    RCLCPP_DEBUG(get_logger(), "noted %f", bounded);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double ceiling_, floor_, left_, right_, limit_, noted_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
