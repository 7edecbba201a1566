// A lifecycle node changes its own state.
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp_lifecycle::LifecycleNode {
public:
  Guard() : LifecycleNode("exp_lifecycle_trigger") {
    limit_ = declare_parameter("limit", 5.0);
    low_ = declare_parameter<double>("low", -3.0);
    noted_ = declare_parameter("noted", 4.0);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    pub_->publish(msg);
    if (msg.data > limit_)
      deactivate();
    if (msg.data < low_)
      RCLCPP_DEBUG(get_logger(), "low");
    if (msg.data > noted_)
      ++notes_;
  }

  rclcpp_lifecycle::LifecyclePublisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_, low_, noted_;
  int notes_ = 0;
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
