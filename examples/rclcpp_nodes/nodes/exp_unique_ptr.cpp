// Messages are handed over by unique pointers, inside of one process.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard()
      : Node("exp_unique_ptr",
             rclcpp::NodeOptions().use_intra_process_comms(true)) {
    limit_ = declare_parameter("limit", 2.0);
    scaled_ = declare_parameter("scaled", 5.0);
    final_ = declare_parameter("final", 8.0);
    pub_ = create_publisher<Float64>("~/output", 100);
    middle_ = create_publisher<Float64>("~/middle", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
    next_ = create_subscription<Float64>(
        "~/middle", 100,
        [this](Float64::UniquePtr msg) { onMiddle(std::move(msg)); });
  }

private:
  void onInput(const Float64 &msg) {
    auto out = std::make_unique<Float64>();
    out->data = msg.data;
    if (msg.data > scaled_)
      out->data *= 2.0;
    if (msg.data > limit_)
      middle_->publish(std::move(out));
  }

  void onMiddle(Float64::UniquePtr msg) {
    if (msg->data > final_)
      pub_->publish(std::move(msg));
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_, middle_;
  rclcpp::Subscription<Float64>::SharedPtr sub_, next_;
  double limit_, scaled_, final_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
