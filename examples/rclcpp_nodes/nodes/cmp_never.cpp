// Negative: a gain, an offset and a frame are never compared.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("cmp_never") {
    gain_ = declare_parameter("gain", 2.0);
    offset_ = declare_parameter("offset", 0.5);
    frame_ = declare_parameter("frame", std::string("map"));
    declare_parameter("unused", 7.0);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    Float64 out;
    out.data = gain_ * msg.data + offset_;
    if (msg.data > 2.0)
      pub_->publish(out);
    RCLCPP_DEBUG(get_logger(), "in %s", frame_.c_str());
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double gain_, offset_;
  std::string frame_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
