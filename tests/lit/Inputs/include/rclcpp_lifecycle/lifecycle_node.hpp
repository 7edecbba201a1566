// The part of rclcpp_lifecycle's interface that the tests use; see rclcpp.hpp.
#ifndef TPC_TEST_LIFECYCLE_NODE_H
#define TPC_TEST_LIFECYCLE_NODE_H

#include <rclcpp/rclcpp.hpp>

namespace rclcpp_lifecycle {

template <typename M, typename A = std::allocator<void>>
class LifecyclePublisher : public rclcpp::Publisher<M, A> {
public:
  virtual void publish(const M &Message);
};

class LifecycleNode {
public:
  explicit LifecycleNode(const std::string &Name);
  virtual ~LifecycleNode();
  const char *get_fully_qualified_name() const;
  void deactivate();
  rclcpp::Parameter get_parameter(const std::string &Name) const;
  const rclcpp::ParameterValue &declare_parameter(
      const std::string &Name, const rclcpp::ParameterValue &Default,
      const rcl_interfaces::msg::ParameterDescriptor &Descriptor =
          rcl_interfaces::msg::ParameterDescriptor(),
      bool IgnoreOverride = false);
  template <typename M>
  std::shared_ptr<LifecyclePublisher<M>>
  create_publisher(const std::string &Topic, const rclcpp::QoS &) {
    return std::make_shared<LifecyclePublisher<M>>();
  }
};

} // namespace rclcpp_lifecycle

#endif // TPC_TEST_LIFECYCLE_NODE_H
