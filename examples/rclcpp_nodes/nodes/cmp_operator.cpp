// Objects with an operator of the program itself hold the parameters.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

struct Level {
  double value = 0.0;
  bool operator<(const Level &other) const { return value < other.value; }
};
bool operator==(const Level &one, const Level &other) {
  return one.value == other.value;
}

class Guard : public rclcpp::Node {
public:
  Guard() : Node("cmp_operator") {
    limit_.value = declare_parameter("limit", 5.0);
    low_.value = declare_parameter("low", -3.0);
    same_.value = declare_parameter("same", 3.0);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    const Level level{msg.data};
    if (limit_ < level)
      pub_->publish(msg);
    if (level < low_)
      pub_->publish(msg);
    if (level == same_)
      pub_->publish(msg);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  Level limit_, low_, same_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
