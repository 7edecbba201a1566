// get_parameter_or in both forms, for parameters that may be given or not.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("read_get_or") {
    declare_parameter("low", -3.0);
    get_parameter_or("limit", limit_, 5.0);
    get_parameter_or<double>("low", low_, 0.0);
    far_ = get_parameter_or("far", 8.0);
    most_ = get_parameter_or<int64_t>("most", 3);
    get_parameter_or("noted", noted_, 4.0);
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
    if (far_ < msg.data)
      pub_->publish(msg);
    if (++count_ <= most_)
      pub_->publish(msg);
    if (msg.data > noted_)
      RCLCPP_DEBUG(get_logger(), "noted");
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_, low_, far_, noted_;
  int64_t most_, count_ = 0;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
