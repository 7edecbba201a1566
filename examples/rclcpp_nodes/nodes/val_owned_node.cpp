// No subclass: the class owns its node.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard {
public:
  Guard() : node_(rclcpp::Node::make_shared("val_owned_node")) {
    limit_ = node_->declare_parameter("limit", 5.0);
    node_->declare_parameter("low", -3.0);
    node_->get_parameter("low", low_);
    pub_ = node_->create_publisher<Float64>("~/output", 100);
    sub_ = node_->create_subscription<Float64>(
        "input", 100, std::bind(&Guard::onInput, this, std::placeholders::_1));
  }
  rclcpp::Node::SharedPtr node() const { return node_; }

private:
  void onInput(const Float64::ConstSharedPtr &msg) {
    if (msg->data > limit_)
      pub_->publish(*msg);
    if (msg->data < low_)
      send(*msg);
  }
  void send(const Float64 &msg) { pub_->publish(msg); }

  rclcpp::Node::SharedPtr node_;
  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_, low_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  Guard guard;
  rclcpp::spin(guard.node());
  rclcpp::shutdown();
  return 0;
}
