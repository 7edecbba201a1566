// Texts that are compared, with operators, compare and another text.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("cmp_strings") {
    mode_ = declare_parameter("mode", std::string("high"));
    declare_parameter("side", "left");
    side_ = get_parameter("side").as_string();
    unit_ = declare_parameter<std::string>("unit", "m");
    frame_ = declare_parameter("frame", std::string("map"));
    log_ = declare_parameter("log", std::string("none"));
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    Float64 out;
    out.data = unit_.compare("cm") == 0 ? 100.0 * msg.data : msg.data;
    if (mode_ == "high" && msg.data > 0.0)
      pub_->publish(out);
    if ("right" != side_)
      pub_->publish(out);
    const std::string wanted = msg.data > 0.0 ? "map" : "odom";
    if (wanted == frame_)
      pub_->publish(out);
    if (log_ == "all")
      RCLCPP_DEBUG(get_logger(), "all");
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  std::string mode_, side_, unit_, frame_, log_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
