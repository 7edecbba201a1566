// Timers by create_timer and create_generic_timer share their state.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("ctl_two_timers") {
    limit_ = declare_parameter("limit", 5.0);
    wait_ = declare_parameter("wait", 2);
    group_ =
        create_callback_group(rclcpp::CallbackGroupType::MutuallyExclusive);
    watch_ =
        create_timer(std::chrono::milliseconds(5), [this] { watch(); }, group_);
    tell_ = create_wall_timer(
        std::chrono::milliseconds(5), [this] { tell(); }, group_);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) { value_ = msg.data; }

  void watch() {
    if (value_ > limit_)
      ++high_;
  }

  void tell() {
    if (high_ < wait_ || told_)
      return;
    told_ = true;
    Float64 out;
    out.data = wait_;
    pub_->publish(out);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  rclcpp::CallbackGroup::SharedPtr group_;
  rclcpp::TimerBase::SharedPtr watch_, tell_;
  double limit_, value_ = 0.0;
  int wait_, high_ = 0;
  bool told_ = false;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
