// A callback refuses values; what it returns is what set_parameters answers.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("val_refused") {
    most_ = declare_parameter("most", 8.0);
    limit_ = declare_parameter("limit", 5.0);
    handle_ = add_on_set_parameters_callback(
        [this](const std::vector<rclcpp::Parameter> &all) {
          return check(all);
        });
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  rcl_interfaces::msg::SetParametersResult
  check(const std::vector<rclcpp::Parameter> &parameters) {
    rcl_interfaces::msg::SetParametersResult result;
    result.successful = true;
    for (const auto &parameter : parameters) {
      if (parameter.get_name() != "limit")
        continue;
      const double value = parameter.as_double();
      if (value < 0.0) {
        result.successful = false;
        result.reason = "negative";
      } else if (value > most_) {
        result.successful = false;
        result.reason = "too high";
      }
      if (value > 100.0)
        RCLCPP_DEBUG(get_logger(), "very high");
      if (result.successful)
        limit_ = value;
    }
    return result;
  }

  void onInput(const Float64 &msg) {
    const auto answer = set_parameter(rclcpp::Parameter("limit", msg.data));
    Float64 out;
    out.data = answer.successful ? limit_ : -1.0;
    pub_->publish(out);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  OnSetParametersCallbackHandle::SharedPtr handle_;
  double most_, limit_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
