// The result of a comparison is kept, handed on or published.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("cmp_kept") {
    limit_ = declare_parameter("limit", 5.0);
    low_ = declare_parameter("low", -3.0);
    far_ = declare_parameter("far", 8.0);
    noted_ = declare_parameter("noted", 4.0);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    const bool isHigh = msg.data > limit_;
    wasLow_ = msg.data < low_;
    const bool isNoted = msg.data > noted_;
    if (isHigh || wasLow_)
      pub_->publish(msg);
    if (isNoted)
      RCLCPP_DEBUG(get_logger(), "noted");
    Float64 out;
    out.data = msg.data > far_;
    pub_->publish(out);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_, low_, far_, noted_;
  bool wasLow_ = false;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
