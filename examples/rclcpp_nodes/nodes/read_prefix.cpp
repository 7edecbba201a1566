// get_parameters fills a map with all parameters below a prefix.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("read_prefix") {
    declare_parameter("limits.high", 5.0);
    declare_parameter("limits.low", -3.0);
    declare_parameter("noted.above", 4.0);
    std::map<std::string, double> limits, noted;
    get_parameters("limits", limits);
    high_ = limits["high"];
    low_ = limits.at("low");
    if (get_parameters("noted", noted))
      noted_ = noted["above"];
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    if (msg.data > high_)
      pub_->publish(msg);
    if (msg.data < low_)
      pub_->publish(msg);
    if (msg.data > noted_)
      RCLCPP_DEBUG(get_logger(), "noted");
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double high_, low_, noted_ = 0.0;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
