// A broadcaster keeps its publisher and sends transforms.
#include <geometry_msgs/msg/transform_stamped.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using geometry_msgs::msg::TransformStamped;
using std_msgs::msg::Float64;

class Broadcaster {
public:
  template <typename NodeT>
  explicit Broadcaster(NodeT &&node)
      : publisher_(rclcpp::create_publisher<TransformStamped>(
            node, "~/transform", rclcpp::QoS(100))) {}
  void sendTransform(const TransformStamped &transform) {
    sendTransform(std::vector<TransformStamped>{transform});
  }
  void sendTransform(const std::vector<TransformStamped> &transforms) {
    for (const auto &each : transforms)
      publisher_->publish(each);
  }

private:
  rclcpp::Publisher<TransformStamped>::SharedPtr publisher_;
};

class Guard : public rclcpp::Node {
public:
  Guard() : Node("exp_broadcaster") {
    limit_ = declare_parameter("limit", 2.0);
    turned_ = declare_parameter("turned", 5.0);
    noted_ = declare_parameter("noted", 4.0);
    broadcaster_ = std::make_unique<Broadcaster>(*this);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    TransformStamped transform;
    transform.header.frame_id = "map";
    transform.transform.translation.x = msg.data;
    if (msg.data > turned_)
      transform.transform.rotation.z = 1.0;
    if (msg.data > noted_)
      RCLCPP_DEBUG(get_logger(), "noted");
    if (msg.data > limit_)
      broadcaster_->sendTransform(transform);
  }

  std::unique_ptr<Broadcaster> broadcaster_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_, turned_, noted_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
