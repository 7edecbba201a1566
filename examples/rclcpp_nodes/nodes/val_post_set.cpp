// A callback after the change takes the new values, in a class of its own.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("val_post_set") {
    declare_parameter("limit", 1.0);
    declare_parameter("low", -1.0);
    handle_ = add_post_set_parameters_callback(
        [this](const std::vector<rclcpp::Parameter> &parameters) {
          for (const rclcpp::Parameter &parameter : parameters) {
            if (parameter.get_name() == "limit")
              limit_ = parameter.as_double();
            if (parameter.get_name() == "low")
              low_ = parameter.get_value<double>();
          }
        });
    set_parameters({rclcpp::Parameter("limit", 5.0)});
    set_parameters_atomically({rclcpp::Parameter("low", -3.0)});
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
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  PostSetParametersCallbackHandle::SharedPtr handle_;
  double limit_ = 1.0, low_ = -1.0;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
