// A callback takes new values, told apart by their names.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("val_set_callback") {
    declare_parameter("limit", 1.0);
    declare_parameter("low", -1.0);
    declare_parameter("noted", 4.0);
    handle_ = add_on_set_parameters_callback(
        std::bind(&Guard::onSet, this, std::placeholders::_1));
    set_parameter(rclcpp::Parameter("limit", 5.0));
    set_parameter(rclcpp::Parameter("low", -3.0));
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  rcl_interfaces::msg::SetParametersResult
  onSet(const std::vector<rclcpp::Parameter> &parameters) {
    rcl_interfaces::msg::SetParametersResult result;
    result.successful = true;
    for (const auto &parameter : parameters) {
      const auto &type = parameter.get_type();
      const auto &name = parameter.get_name();
      if (type == rclcpp::ParameterType::PARAMETER_DOUBLE) {
        if (name == "limit")
          limit_ = parameter.as_double();
        else if (name == "low")
          low_ = parameter.as_double();
        else if (name == "noted")
          noted_ = parameter.as_double();
      }
    }
    return result;
  }

  void onInput(const Float64 &msg) {
    if (msg.data > limit_)
      pub_->publish(msg);
    if (msg.data < low_)
      pub_->publish(msg);
    if (msg.data > noted_)
      RCLCPP_DEBUG(get_logger(), "noted");
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  OnSetParametersCallbackHandle::SharedPtr handle_;
  double limit_ = 1.0, low_ = -1.0, noted_ = 4.0;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
