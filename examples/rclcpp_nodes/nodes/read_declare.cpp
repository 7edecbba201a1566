// Declares parameters with a type, a default of a deduced type, and a value.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("read_declare") {
    limit_ = declare_parameter<double>("limit", 5.0);
    low_ = declare_parameter("low", -3.0);
    skip_ = static_cast<int>(declare_parameter<int64_t>("skip", 2));
    enabled_ = declare_parameter("enabled", true);
    top_ = declare_parameter("top", rclcpp::ParameterValue(8.0)).get<double>();
    given_ = declare_parameter<double>("given");
    noted_ = declare_parameter<double>("noted", 4.0);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, std::bind(&Guard::onInput, this, std::placeholders::_1));
  }

private:
  void onInput(const Float64::SharedPtr msg) {
    ++count_;
    if (msg->data > limit_)
      pub_->publish(*msg);
    if (msg->data < low_)
      pub_->publish(*msg);
    if (count_ > skip_)
      pub_->publish(*msg);
    if (enabled_)
      pub_->publish(*msg);
    if (msg->data > top_)
      pub_->publish(*msg);
    if (msg->data >= given_)
      pub_->publish(*msg);
    if (msg->data > noted_)
      RCLCPP_DEBUG(get_logger(), "noted");
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_, low_, top_, given_, noted_;
  int skip_;
  int count_ = 0;
  bool enabled_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
