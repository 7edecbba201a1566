// Messages that are borrowed from the publisher, and messages as bytes.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("exp_loaned") {
    limit_ = declare_parameter("limit", 5.0);
    scaled_ = declare_parameter("scaled", 2.0);
    low_ = declare_parameter("low", -3.0);
    pub_ = create_publisher<Float64>("~/output", 100);
    bytes_ = create_generic_publisher("~/bytes", "std_msgs/msg/Float64",
                                      rclcpp::QoS(100));
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
  }

private:
  void onInput(const Float64 &msg) {
    auto loaned = pub_->borrow_loaned_message();
    loaned.get().data = msg.data;
    if (msg.data > scaled_)
      loaned.get().data *= 2.0;
    if (msg.data <= limit_)
      pub_->publish(std::move(loaned));
    if (msg.data < low_) {
      rclcpp::SerializedMessage serialized;
      rclcpp::Serialization<Float64>().serialize_message(&msg, &serialized);
      bytes_->publish(serialized);
    }
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::GenericPublisher::SharedPtr bytes_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_, scaled_, low_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
