// Ranges, ternary operators and loops.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("cmp_chained") {
    low_ = declare_parameter("low", -3.0);
    high_ = declare_parameter("high", 5.0);
    repeats_ = declare_parameter("repeats", 2);
    limit_ = declare_parameter("limit", 8.0);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    const bool isInside = low_ <= msg.data && msg.data <= high_;
    if (isInside)
      pub_->publish(msg);
    for (int at = 0; at < repeats_; ++at)
      pub_->publish(msg);
    Float64 out;
    out.data = msg.data > limit_ ? limit_ : msg.data;
    pub_->publish(out);
    int more = 0;
    while (more++ < repeats_)
      RCLCPP_DEBUG(get_logger(), "more");
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double low_, high_, limit_;
  int repeats_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
