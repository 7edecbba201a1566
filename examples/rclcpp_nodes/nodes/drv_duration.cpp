// Durations and times: made of parameters, compared, added and subtracted.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("drv_duration") {
    patience_ =
        rclcpp::Duration::from_seconds(declare_parameter("patience", 3.5));
    grace_ = rclcpp::Duration(std::chrono::nanoseconds(
        declare_parameter<int64_t>("grace_ns", 5000000000)));
    maxAge_ = declare_parameter("max_age", 8.0);
    pause_ = declare_parameter("pause_ms", 500);
    first_ = declare_parameter("first", 1.0);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    const rclcpp::Time stamp(static_cast<int64_t>((100 + msg.data) * 1e9));
    const rclcpp::Duration age = stamp - start_;
    if (stamp - last_ > patience_) {
      last_ = stamp;
      pub_->publish(msg);
    }
    if (age > grace_)
      pub_->publish(msg);
    if (age.seconds() > maxAge_)
      pub_->publish(msg);
    if (age < rclcpp::Duration(0, pause_ * 1000000))
      pub_->publish(msg);
    if (stamp < start_ + rclcpp::Duration::from_seconds(first_))
      pub_->publish(msg);
    if (now() - began_ > rclcpp::Duration::from_seconds(3600 * first_))
      pub_->publish(msg);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  rclcpp::Duration patience_{0, 0}, grace_{0, 0};
  double maxAge_, first_;
  int pause_;
  const rclcpp::Time start_{100, 0};
  rclcpp::Time last_{90, 0};
  const rclcpp::Time began_{now()};
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
