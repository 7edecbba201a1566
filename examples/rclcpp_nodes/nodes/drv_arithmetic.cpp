// Degrees, squares, roots, quotients and sums with constants.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

#include <cmath>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("drv_arithmetic") {
    angle_ = declare_parameter("angle_deg", 180.0) * M_PI / 180.0;
    radius_ = declare_parameter("radius", 3.0);
    variance_ = declare_parameter("variance", 4.0);
    rate_ = declare_parameter("rate", 0.2);
    width_ = declare_parameter("width", 6);
    margin_ = declare_parameter("margin", 2.0);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    if (msg.data > angle_)
      pub_->publish(msg);
    if (msg.data * msg.data < radius_ * radius_)
      pub_->publish(msg);
    if (std::abs(msg.data) > std::sqrt(variance_))
      pub_->publish(msg);
    if (msg.data >= 1.0 / rate_)
      pub_->publish(msg);
    if (msg.data > width_ / 2)
      pub_->publish(msg);
    if (msg.data + 1.0 > margin_)
      pub_->publish(msg);
    if (std::hypot(msg.data, 0.0) < std::pow(margin_, 2))
      pub_->publish(msg);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double angle_, radius_, variance_, rate_, margin_;
  int width_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
