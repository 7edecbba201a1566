// Parameters that are declared because somebody sets them at the start.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard()
      : Node("read_undeclared",
             rclcpp::NodeOptions()
                 .allow_undeclared_parameters(true)
                 .automatically_declare_parameters_from_overrides(true)) {
    if (has_parameter("limit"))
      limit_ = get_parameter("limit").as_double();
    const rclcpp::Parameter low = get_parameter("low");
    if (low.get_type() == rclcpp::ParameterType::PARAMETER_DOUBLE)
      low_ = low.as_double();
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
    double far = 0.0;
    if (get_parameter("far", far) && msg.data > far)
      pub_->publish(msg);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_ = 100.0, low_ = -100.0;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
