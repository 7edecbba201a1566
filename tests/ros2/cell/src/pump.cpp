// A lifecycle node that configures, activates and deactivates itself.
#include <chrono>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <std_msgs/msg/float64.hpp>

using Return = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;

class Pump : public rclcpp_lifecycle::LifecycleNode {
public:
  Pump() : LifecycleNode("pump", "/plant") {
    declare_parameter("pressure", 5.0);
    declare_parameter("rate", 100.0);
    declare_parameter("steps", 40);
  }

  Return on_configure(const rclcpp_lifecycle::State &) override {
    Pressure = get_parameter("pressure").as_double();
    Steps = get_parameter("steps").as_int();
    const double Rate = get_parameter("rate").as_double();
    if (Rate <= 0) // rate
      return Return::FAILURE;
    Flow = create_publisher<std_msgs::msg::Float64>("flow", 10);
    Timer = create_wall_timer(std::chrono::duration<double>(1 / Rate), [this] { step(); });
    return Return::SUCCESS;
  }

private:
  void step() {
    auto M = std::make_unique<std_msgs::msg::Float64>();
    M->data = double(N % 10);
    if (M->data > Pressure) // pressure
      Flow->publish(std::move(M));
    if (++N >= Steps) { // steps
      deactivate();
      rclcpp::shutdown();
    }
  }

  double Pressure = 0;
  int64_t Steps = 0, N = 0;
  rclcpp_lifecycle::LifecyclePublisher<std_msgs::msg::Float64>::SharedPtr Flow;
  rclcpp::TimerBase::SharedPtr Timer;
};

int main(int Count, char **Words) {
  rclcpp::init(Count, Words);
  auto Node = std::make_shared<Pump>();
  Node->configure();
  Node->activate();
  rclcpp::spin(Node->get_node_base_interface());
  rclcpp::shutdown();
}
