// Thresholds decide what is in a message that is published in any case.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>
#include <std_msgs/msg/float64_multi_array.hpp>

using std_msgs::msg::Float64;
using std_msgs::msg::Float64MultiArray;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("exp_message_fields") {
    limit_ = declare_parameter("limit", 5.0);
    low_ = declare_parameter("low", -3.0);
    noted_ = declare_parameter("noted", 4.0);
    many_ = create_publisher<Float64MultiArray>("~/many", 100);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  double bounded(double value) const {
    if (value > limit_)
      return limit_;
    return value;
  }

  void onInput(const Float64 &msg) {
    Float64 out;
    out.data = bounded(msg.data);
    pub_->publish(out);
    Float64MultiArray many;
    many.data.push_back(msg.data);
    if (msg.data < low_)
      many.data.push_back(low_);
    double notes = 0.0;
    if (msg.data > noted_)
      notes = 1.0;
    RCLCPP_DEBUG(get_logger(), "%f", notes);
    many_->publish(many);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  rclcpp::Publisher<Float64MultiArray>::SharedPtr many_;
  double limit_, low_, noted_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
