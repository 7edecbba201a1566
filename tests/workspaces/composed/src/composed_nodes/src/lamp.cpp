#include <composed_limits/limit.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

namespace composed {
// The container does not load it: nothing of it may be reported.
class Lamp : public rclcpp::Node {
public:
  explicit Lamp(const rclcpp::NodeOptions &options) : Node("lamp", options) {
    limit_.set(declare_parameter("lamp_limit", 0.5));
    on_ = create_publisher<Float64>("lamp", 10);
    light_ = create_subscription<Float64>("light", 10, [this](const Float64 &message) {
      if (limit_.is_passed_by(message.data))
        on_->publish(message);
    });
  }

private:
  Limit limit_;
  rclcpp::Publisher<Float64>::SharedPtr on_;
  rclcpp::Subscription<Float64>::SharedPtr light_;
};
} // namespace composed
RCLCPP_COMPONENTS_REGISTER_NODE(composed::Lamp)
