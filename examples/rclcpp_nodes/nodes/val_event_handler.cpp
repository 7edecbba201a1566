// A handler calls back with one parameter that has changed.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("val_event_handler") {
    limit_ = declare_parameter("limit", 5.0);
    low_ = declare_parameter("low", -3.0);
    handler_ = std::make_shared<rclcpp::ParameterEventHandler>(this);
    onLimit_ = handler_->add_parameter_callback(
        "limit",
        [this](const rclcpp::Parameter &p) { limit_ = p.as_double(); });
    const auto onLow = [this](const rclcpp::Parameter &parameter) {
      low_ = parameter.get_value<double>();
    };
    onLow_ = handler_->add_parameter_callback("low", onLow);
    onFar_ = handler_->add_parameter_callback(
        "far", [this](const rclcpp::Parameter &p) { far_ = p.as_double(); },
        "/somebody_else");
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
  std::shared_ptr<rclcpp::ParameterEventHandler> handler_;
  rclcpp::ParameterCallbackHandle::SharedPtr onLimit_, onLow_, onFar_;
  double limit_, low_, far_ = 100.0;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
