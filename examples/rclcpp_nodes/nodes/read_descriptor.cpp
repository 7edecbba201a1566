// Parameters that are declared with a description, a range and a type.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("read_descriptor") {
    rcl_interfaces::msg::ParameterDescriptor described;
    described.description = "publishes above it";
    rcl_interfaces::msg::FloatingPointRange range;
    range.from_value = -10.0;
    range.to_value = 10.0;
    described.floating_point_range.push_back(range);
    limit_ = declare_parameter<double>("limit", 5.0, described);
    low_ = declare_parameter("low", -3.0, described, true);
    const auto &given =
        declare_parameter("given", rclcpp::ParameterType::PARAMETER_DOUBLE);
    given_ = given.get<double>();
    noted_ = declare_parameter("noted", 4.0, described);
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
    if (msg.data >= given_)
      pub_->publish(msg);
    if (msg.data > noted_)
      RCLCPP_DEBUG(get_logger(), "noted");
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_, low_, given_, noted_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
