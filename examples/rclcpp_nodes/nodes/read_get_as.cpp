// get_parameter returns an object whose methods give the value, here and in
// the callback.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("read_get_as") {
    declare_parameter("limit", 5.0);
    declare_parameter("skip", 2);
    declare_parameter("invert", false);
    declare_parameter("mode", "normal");
    declare_parameter("low", -3.0);
    declare_parameter("noted", 4.0);
    limit_ = get_parameter("limit").as_double();
    skip_ = get_parameter("skip").as_int();
    invert_ = get_parameter("invert").as_bool();
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    Float64 out;
    out.data = invert_ ? -msg.data : msg.data;
    if (msg.data > limit_)
      pub_->publish(out);
    if (++count_ > skip_)
      pub_->publish(out);
    if (get_parameter("mode").as_string() == "normal")
      pub_->publish(out);
    if (msg.data < this->get_parameter("low").as_double())
      pub_->publish(out);
    if (msg.data > get_parameter("noted").as_double())
      RCLCPP_DEBUG(get_logger(), "noted");
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_;
  int64_t skip_, count_ = 0;
  bool invert_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
