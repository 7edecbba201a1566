// Negative: only the library compares the values, deep in its own code.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("cmp_inside_library") {
    const int depth = declare_parameter("depth", 100);
    const double period = declare_parameter("period", 3600.0);
    const double lifespan = declare_parameter("lifespan", 60.0);
    const std::string topic = declare_parameter("topic", "input");
    rclcpp::QoS qos(depth);
    qos.reliable().lifespan(rclcpp::Duration::from_seconds(lifespan));
    pub_ = create_publisher<Float64>("~/output", qos);
    sub_ = create_subscription<Float64>(
        topic, rclcpp::QoS(rclcpp::KeepLast(depth)),
        [this](const Float64 &msg) { pub_->publish(msg); });
    timer_ = create_wall_timer(std::chrono::duration<double>(period),
                               [this] { pub_->publish(Float64()); });
    values_.reserve(depth);
  }

private:
  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  rclcpp::TimerBase::SharedPtr timer_;
  std::vector<double> values_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
