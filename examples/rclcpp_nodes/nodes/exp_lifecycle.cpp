// A lifecycle node: its publisher, and what its callbacks return.
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <std_msgs/msg/float64.hpp>

using CallbackReturn =
    rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;
using std_msgs::msg::Float64;

class Guard : public rclcpp_lifecycle::LifecycleNode {
public:
  Guard() : LifecycleNode("exp_lifecycle") {
    declare_parameter("limit", 5.0);
    declare_parameter("low", -3.0);
    declare_parameter("least", 1.0);
    declare_parameter("noted", 4.0);
  }

  CallbackReturn on_configure(const rclcpp_lifecycle::State &) override {
    limit_ = get_parameter("limit").as_double();
    get_parameter("low", low_);
    get_parameter("noted", noted_);
    if (limit_ < get_parameter("least").as_double()) {
      RCLCPP_ERROR(get_logger(), "the limit is too low");
      return CallbackReturn::FAILURE;
    }
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
    return CallbackReturn::SUCCESS;
  }

  CallbackReturn on_activate(const rclcpp_lifecycle::State &) override {
    pub_->on_activate();
    if (limit_ > noted_)
      RCLCPP_DEBUG(get_logger(), "noted");
    return CallbackReturn::SUCCESS;
  }

private:
  void onInput(const Float64 &msg) {
    if (msg.data > limit_)
      pub_->publish(msg);
    if (msg.data < low_) {
      auto out = std::make_unique<Float64>(msg);
      pub_->publish(std::move(out));
    }
  }

  rclcpp_lifecycle::LifecyclePublisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_, low_, noted_;
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
