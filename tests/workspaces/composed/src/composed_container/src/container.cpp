#include <rclcpp/rclcpp.hpp>
#include <rclcpp_components/component_manager.hpp>

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  auto executor = std::make_shared<rclcpp::executors::SingleThreadedExecutor>();
  executor->add_node(std::make_shared<rclcpp_components::ComponentManager>(executor));
  executor->spin();
  rclcpp::shutdown();
}
