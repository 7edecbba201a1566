// A struct of all parameters and a listener that fills it, in the form that
// generators of parameter code write.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

#include <mutex>

using std_msgs::msg::Float64;

struct Params {
  double limit = 5.0;
  int64_t most = 3;
  double noted = 4.0;
  struct Arm {
    double low = -3.0;
  } arm;
};

class ParamListener {
public:
  explicit ParamListener(
      rclcpp::node_interfaces::NodeParametersInterface::SharedPtr interface)
      : interface_(std::move(interface)) {
    declare();
    handle_ = interface_->add_on_set_parameters_callback(
        [this](const std::vector<rclcpp::Parameter> &all) { return set(all); });
  }
  Params get_params() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return params_;
  }

private:
  void declare() {
    Params updated = get_params();
    if (!interface_->has_parameter("limit")) {
      rcl_interfaces::msg::ParameterDescriptor descriptor;
      descriptor.description = "the upper limit";
      interface_->declare_parameter(
          "limit", rclcpp::ParameterValue(updated.limit), descriptor);
    }
    if (!interface_->has_parameter("most"))
      interface_->declare_parameter("most",
                                    rclcpp::ParameterValue(updated.most));
    if (!interface_->has_parameter("noted"))
      interface_->declare_parameter("noted",
                                    rclcpp::ParameterValue(updated.noted));
    if (!interface_->has_parameter("arm.low"))
      interface_->declare_parameter("arm.low",
                                    rclcpp::ParameterValue(updated.arm.low));
    rclcpp::Parameter param = interface_->get_parameter("limit");
    updated.limit = param.as_double();
    param = interface_->get_parameter("most");
    updated.most = param.as_int();
    param = interface_->get_parameter("noted");
    updated.noted = param.as_double();
    param = interface_->get_parameter("arm.low");
    updated.arm.low = param.as_double();
    const std::lock_guard<std::mutex> lock(mutex_);
    params_ = updated;
  }

  rcl_interfaces::msg::SetParametersResult
  set(const std::vector<rclcpp::Parameter> &all) {
    Params updated = get_params();
    for (const auto &param : all) {
      if (param.get_name() == "limit")
        updated.limit = param.as_double();
      if (param.get_name() == "most")
        updated.most = param.as_int();
      if (param.get_name() == "noted")
        updated.noted = param.as_double();
      if (param.get_name() == "arm.low")
        updated.arm.low = param.as_double();
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    params_ = updated;
    rcl_interfaces::msg::SetParametersResult result;
    result.successful = true;
    return result;
  }

  mutable std::mutex mutex_;
  Params params_;
  rclcpp::node_interfaces::NodeParametersInterface::SharedPtr interface_;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr handle_;
};

class Guard : public rclcpp::Node {
public:
  Guard() : Node("read_listener"), listener_(get_node_parameters_interface()) {
    params_ = listener_.get_params();
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    params_ = listener_.get_params();
    if (msg.data > params_.limit)
      pub_->publish(msg);
    if (++count_ <= params_.most)
      pub_->publish(msg);
    if (msg.data < params_.arm.low)
      pub_->publish(msg);
    if (msg.data > params_.noted)
      RCLCPP_DEBUG(get_logger(), "noted");
  }

  ParamListener listener_;
  Params params_;
  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  int64_t count_ = 0;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
