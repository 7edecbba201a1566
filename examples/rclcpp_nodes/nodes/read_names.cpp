// Names are put together from a prefix that the plugin's owner chose.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Checker {
public:
  void initialize(rclcpp::Node &node, const std::string &name) {
    name_ = name;
    node.declare_parameter(name_ + ".limit", 5.0);
    node.get_parameter(name_ + ".limit", limit_);
    low_ = node.declare_parameter(name_ + ".arm." + "low", -3.0);
  }
  bool isHigh(double value) const { return value > limit_; }
  bool isLow(double value) const { return value < low_; }

private:
  std::string name_;
  double limit_ = 0.0, low_ = 0.0;
};

class Guard : public rclcpp::Node {
public:
  Guard() : Node("read_names") {
    checker_.initialize(*this, "checker");
    const std::string side = declare_parameter("side", std::string("left"));
    declare_parameter(side + ".far", 8.0);
    far_ = get_parameter(side + ".far").as_double();
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    if (checker_.isHigh(msg.data))
      pub_->publish(msg);
    if (checker_.isLow(msg.data))
      pub_->publish(msg);
    if (msg.data > far_)
      pub_->publish(msg);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  Checker checker_;
  double far_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
