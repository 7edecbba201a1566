// get_parameters returns a vector of parameters in the order of the names.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("read_get_many") {
    declare_parameter("limit", 5.0);
    declare_parameter("low", -3.0);
    declare_parameter("far", 8.0);
    const auto both = get_parameters({"limit", "low"});
    limit_ = both[0].as_double();
    low_ = both.at(1).as_double();
    for (const auto &each : get_parameters({"far"}))
      far_ = each.get_value<double>();
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    if (msg.data > limit_)
      pub_->publish(msg);
    if (msg.data < low_)
      pub_->publish(msg);
    if (msg.data > far_)
      pub_->publish(msg);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_, low_, far_ = 0.0;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
