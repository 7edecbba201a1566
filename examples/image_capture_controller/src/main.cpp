/// The controller as a process of its own, which configures itself.

#include "image_capture_controller/flight_controller.hpp"

#include <rclcpp/rclcpp.hpp>

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  {
    const auto node =
        std::make_shared<image_capture_controller::FlightController>(
            rclcpp::NodeOptions());
    node->configure();
    node->activate();
    rclcpp::spin(node->get_node_base_interface());
  }
  rclcpp::shutdown();
  return 0;
}
