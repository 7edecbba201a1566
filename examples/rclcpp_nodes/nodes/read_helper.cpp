// A helper declares a parameter unless somebody else has.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using rcl_interfaces::msg::ParameterDescriptor;
using std_msgs::msg::Float64;

template <typename NodeT>
void declare_parameter_if_not_declared(
    NodeT node, const std::string &name, const rclcpp::ParameterValue &value,
    const ParameterDescriptor &descriptor = ParameterDescriptor()) {
  if (!node->has_parameter(name))
    node->declare_parameter(name, value, descriptor);
}

template <typename T, typename NodeT>
T parameter_of(NodeT node, const std::string &name, const T &value) {
  declare_parameter_if_not_declared(node, name, rclcpp::ParameterValue(value));
  return node->get_parameter(name).template get_value<T>();
}

class Guard : public rclcpp::Node {
public:
  Guard() : Node("read_helper") {
    declare_parameter_if_not_declared(this, "limit",
                                      rclcpp::ParameterValue(5.0));
    get_parameter("limit", limit_);
    low_ = parameter_of(this, "low", -3.0);
    most_ = parameter_of<int64_t>(this, "most", 3);
    noted_ = parameter_of(this, "noted", 4.0);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    if (msg.data > limit_)
      pub_->publish(msg);
    if (msg.data < low_)
      pub_->publish(msg);
    if (++count_ <= most_)
      pub_->publish(msg);
    if (msg.data > noted_)
      RCLCPP_DEBUG(get_logger(), "noted");
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_, low_, noted_;
  int64_t most_, count_ = 0;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
