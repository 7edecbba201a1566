// Declares several parameters at once, in a namespace.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("read_declare_many") {
    declare_parameters<double>("limits", {{"low", -3.0}, {"high", 5.0}});
    const std::map<std::string, double> more = {{"far", 8.0}, {"noted", 4.0}};
    const std::vector<double> values = declare_parameters<double>("more", more);
    count_ = values.size();
    low_ = get_parameter("limits.low").as_double();
    get_parameter("limits.high", high_);
    get_parameter("more.far", far_);
    get_parameter("more.noted", noted_);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    if (msg.data < low_)
      pub_->publish(msg);
    if (msg.data > high_)
      pub_->publish(msg);
    if (msg.data > far_)
      pub_->publish(msg);
    if (msg.data > noted_)
      RCLCPP_DEBUG(get_logger(), "noted %zu", count_);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double low_, high_, far_, noted_;
  size_t count_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
