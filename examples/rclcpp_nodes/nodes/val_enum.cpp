// A text chooses an enumeration, a number is cast to one.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

enum class Mode { None, High, Low };
enum class Level { Little, Full };

class Guard : public rclcpp::Node {
public:
  Guard() : Node("val_enum") {
    const std::string mode = declare_parameter("mode", std::string("high"));
    if (mode == "high")
      mode_ = Mode::High;
    else if (mode == "low")
      mode_ = Mode::Low;
    level_ = static_cast<Level>(declare_parameter("level", 1));
    if (declare_parameter("log", std::string("none")) == "all")
      RCLCPP_DEBUG(get_logger(), "all");
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    switch (mode_) {
    case Mode::High:
      if (msg.data > 5.0)
        pub_->publish(msg);
      break;
    case Mode::Low:
      if (msg.data < -3.0)
        pub_->publish(msg);
      break;
    case Mode::None:
      break;
    }
    if (level_ == Level::Full)
      pub_->publish(msg);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  Mode mode_ = Mode::None;
  Level level_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
