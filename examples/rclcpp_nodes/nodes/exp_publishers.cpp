// Publishers in containers, with topics from parameters, and shared ones.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("exp_publishers") {
    const std::string topic = declare_parameter("topic", "~/named");
    limit_ = declare_parameter("limit", 5.0);
    low_ = declare_parameter("low", -3.0);
    far_ = declare_parameter("far", 8.0);
    noted_ = declare_parameter("noted", 4.0);
    pubs_["high"] = create_publisher<Float64>("~/high", 100);
    pubs_["named"] = create_publisher<Float64>(topic, 100);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void send(const rclcpp::Publisher<Float64>::SharedPtr &to, double value) {
    Float64 out;
    out.data = value;
    to->publish(out);
  }

  void onInput(const Float64 &msg) {
    if (msg.data > limit_)
      pubs_["high"]->publish(msg);
    if (msg.data < low_)
      send(pubs_.at("named"), low_);
    if (msg.data > far_)
      send(pub_, msg.data);
    if (msg.data > noted_ && pub_->get_subscription_count() > 1000)
      RCLCPP_DEBUG(get_logger(), "noted");
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  std::map<std::string, rclcpp::Publisher<Float64>::SharedPtr> pubs_;
  double limit_, low_, far_, noted_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
