#include <composed_limits/limit.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

namespace composed {
class Camera : public rclcpp::Node {
public:
  explicit Camera(const rclcpp::NodeOptions &options) : Node("camera", options) {
    limit_.set(declare_parameter("min_light", 0.5));
    image_ = create_publisher<Float64>("image", 10);
    light_ = create_subscription<Float64>("light", 10, [this](const Float64 &message) {
      if (limit_.is_passed_by(message.data))
        image_->publish(message);
    });
  }

private:
  Limit limit_;
  rclcpp::Publisher<Float64>::SharedPtr image_;
  rclcpp::Subscription<Float64>::SharedPtr light_;
};
} // namespace composed
RCLCPP_COMPONENTS_REGISTER_NODE(composed::Camera)
