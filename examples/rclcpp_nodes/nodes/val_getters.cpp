// Values behind getters, setters and references.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Settings {
public:
  void setLimit(double value) { limit_ = value; }
  double limit() const { return limit_; }
  double &low() { return low_; }
  void setNoted(double value) { noted_ = value; }
  const double &noted() const { return noted_; }

private:
  double limit_ = 0.0, low_ = 0.0, noted_ = 0.0;
};

class Guard : public rclcpp::Node {
public:
  Guard() : Node("val_getters") {
    settings_.setLimit(declare_parameter("limit", 5.0));
    settings_.low() = declare_parameter("low", -3.0);
    settings_.setNoted(declare_parameter("noted", 4.0));
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    if (msg.data > settings_.limit())
      pub_->publish(msg);
    if (settings_.low() > msg.data)
      pub_->publish(msg);
    if (msg.data > settings_.noted())
      RCLCPP_DEBUG(get_logger(), "noted");
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  Settings settings_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
