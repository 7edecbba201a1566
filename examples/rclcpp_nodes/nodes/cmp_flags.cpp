// Parameters that are true or false, alone and in conditions.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("cmp_flags") {
    enabled_ = declare_parameter("enabled", true);
    declare_parameter("invert", false);
    get_parameter("invert", invert_);
    quiet_ = declare_parameter<bool>("quiet", false);
    verbose_ = declare_parameter("verbose", false);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    if (!enabled_)
      return;
    Float64 out;
    out.data = invert_ ? -msg.data : msg.data;
    if (!quiet_ && msg.data > 2.0)
      pub_->publish(out);
    if (verbose_)
      RCLCPP_DEBUG(get_logger(), "noted");
    if (get_parameter("enabled").as_bool())
      pub_->publish(out);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  bool enabled_, invert_, quiet_, verbose_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
