// Early returns, nested conditions and a state between callbacks.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("ctl_early_return") {
    limit_ = declare_parameter("limit", 5.0);
    low_ = declare_parameter("low", -3.0);
    settle_ = declare_parameter("settle", 2);
    noted_ = declare_parameter("noted", 4.0);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    ++count_;
    if (msg.data > noted_) {
      RCLCPP_DEBUG(get_logger(), "noted");
      ++notes_;
    }
    if (count_ < settle_)
      return;
    if (!isArmed_) {
      isArmed_ = msg.data < low_ || count_ == 4;
      return;
    }
    if (msg.data > 0.0) {
      if (msg.data <= limit_)
        return;
      pub_->publish(msg);
    }
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_, low_, noted_;
  int settle_, count_ = 0, notes_ = 0;
  bool isArmed_ = false;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
