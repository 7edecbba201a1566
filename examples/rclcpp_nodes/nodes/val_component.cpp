// A component, which a container or the main program below loads.
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

namespace guards {

class Guard : public rclcpp::Node {
public:
  explicit Guard(const rclcpp::NodeOptions &options)
      : Node("val_component", options) {
    declare_parameter("limit", 5.0);
    limit_ = get_parameter("limit").as_double();
    low_ = declare_parameter<double>("low", -3.0);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100,
        [this](Float64::UniquePtr msg) { onInput(std::move(msg)); });
  }

private:
  void onInput(Float64::UniquePtr msg) {
    if (msg->data < low_)
      msg->data = low_;
    else if (msg->data > limit_)
      msg->data = limit_;
    pub_->publish(std::move(msg));
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_, low_;
};

} // namespace guards

RCLCPP_COMPONENTS_REGISTER_NODE(guards::Guard)

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  const auto options = rclcpp::NodeOptions().use_intra_process_comms(true);
  rclcpp::spin(std::make_shared<guards::Guard>(options));
  rclcpp::shutdown();
  return 0;
}
