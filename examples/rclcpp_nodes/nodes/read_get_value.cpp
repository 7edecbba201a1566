// get_value by type and by number of the type, and the ParameterValue.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("read_get_value") {
    declare_parameter("limit", 5.0);
    declare_parameter("low", -3.0);
    declare_parameter("most", 3);
    declare_parameter("far", 8.0);
    declare_parameter("forced", false);
    limit_ = get_parameter("limit").get_value<double>();
    low_ = get_parameter("low").get_parameter_value().get<double>();
    most_ = get_parameter("most")
                .get_value<rclcpp::ParameterType::PARAMETER_INTEGER>();
    const rclcpp::ParameterValue far =
        get_parameter("far").get_parameter_value();
    far_ = far.get<rclcpp::PARAMETER_DOUBLE>();
    get_parameter("forced", forced_);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    if (msg.data > limit_)
      pub_->publish(msg);
    if (msg.data < low_)
      pub_->publish(msg);
    if (++count_ <= most_)
      pub_->publish(msg);
    if (msg.data > far_)
      pub_->publish(msg);
    if (forced_.as_bool())
      pub_->publish(msg);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_, low_, far_;
  int64_t most_, count_ = 0;
  rclcpp::Parameter forced_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
