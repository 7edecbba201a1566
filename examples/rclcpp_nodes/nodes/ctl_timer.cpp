// A timer with a period from a parameter counts, publishes and cancels itself.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("ctl_timer") {
    limit_ = declare_parameter("limit", 5.0);
    most_ = declare_parameter("most", 3);
    noted_ = declare_parameter("noted", 2);
    const auto period =
        std::chrono::duration<double>(declare_parameter("period", 0.01));
    timer_ = create_wall_timer(period, std::bind(&Guard::onTimer, this));
    timer_->cancel();
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    if (msg.data > limit_)
      timer_->reset();
  }

  void onTimer() {
    if (++count_ > most_) {
      timer_->cancel();
      return;
    }
    if (count_ > noted_)
      RCLCPP_DEBUG(get_logger(), "noted");
    Float64 out;
    out.data = count_;
    pub_->publish(out);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  rclcpp::TimerBase::SharedPtr timer_;
  double limit_;
  int most_, noted_;
  int count_ = 0;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
