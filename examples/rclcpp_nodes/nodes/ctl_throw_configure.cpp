// A check throws, and the lifecycle node is not configured.
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <std_msgs/msg/float64.hpp>

#include <stdexcept>

using CallbackReturn =
    rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;
using std_msgs::msg::Float64;

class Guard : public rclcpp_lifecycle::LifecycleNode {
public:
  Guard() : LifecycleNode("ctl_throw_configure") {
    declare_parameter("limit", 5.0);
    declare_parameter("ceiling", 20.0);
    declare_parameter("floor", 0.0);
  }

  CallbackReturn on_configure(const rclcpp_lifecycle::State &) override {
    try {
      limit_ = checked(get_parameter("limit").as_double());
    } catch (const std::invalid_argument &error) {
      RCLCPP_ERROR(get_logger(), "%s", error.what());
      return CallbackReturn::FAILURE;
    }
    if (limit_ < get_parameter("floor").as_double())
      throw std::runtime_error("the limit is too low");
    pub_ = create_publisher<Float64>("~/output", 100);
    pub_->on_activate();
    sub_ =
        create_subscription<Float64>("input", 100, [this](const Float64 &msg) {
          if (msg.data > limit_)
            pub_->publish(msg);
        });
    return CallbackReturn::SUCCESS;
  }

private:
  double checked(double value) {
    if (value > get_parameter("ceiling").as_double())
      throw std::invalid_argument("the limit is too high");
    return value;
  }

  rclcpp_lifecycle::LifecyclePublisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_ = 0.0;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  const auto guard = std::make_shared<Guard>();
  guard->configure();
  guard->activate();
  rclcpp::spin(guard->get_node_base_interface());
  rclcpp::shutdown();
  return 0;
}
