// Values that lambdas capture by value, by reference and with this.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

#include <functional>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("val_lambda") {
    const double limit = declare_parameter("limit", 5.0);
    low_ = declare_parameter("low", -3.0);
    const auto far = std::make_shared<double>(declare_parameter("far", 8.0));
    isHigh_ = [limit](double value) { return value > limit; };
    isFar_ = [far](double value) { return value > *far; };
    far_ = far;
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    if (isHigh_(msg.data))
      pub_->publish(msg);
    const auto isLow = [&](double value) { return value < low_; };
    if (isLow(msg.data))
      pub_->publish(msg);
    if (isFar_(msg.data))
      pub_->publish(msg);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  std::function<bool(double)> isHigh_, isFar_;
  std::shared_ptr<double> far_;
  double low_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
