// get_parameter writes into a variable, a member or a Parameter, and says
// whether it is there.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("read_get_out") {
    declare_parameter("limit", 5.0);
    declare_parameter("low", -3.0);
    declare_parameter("most", 3);
    declare_parameter("far", 8.0);
    declare_parameter("noted", 4.0);
    get_parameter("limit", limit_);
    if (!get_parameter("low", low_))
      RCLCPP_WARN(get_logger(), "no low");
    int most = 0;
    this->get_parameter("most", most);
    most_ = most;
    rclcpp::Parameter far;
    if (get_parameter("far", far))
      far_ = far.as_double();
    get_parameter("noted", noted_);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](Float64::ConstSharedPtr msg) { onInput(msg); });
  }

private:
  void onInput(Float64::ConstSharedPtr msg) {
    if (msg->data > limit_)
      pub_->publish(*msg);
    if (msg->data < low_)
      pub_->publish(*msg);
    if (++count_ <= most_)
      pub_->publish(*msg);
    if (msg->data > far_)
      pub_->publish(*msg);
    if (msg->data > noted_)
      RCLCPP_DEBUG(get_logger(), "noted");
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_ = 0.0, low_ = 0.0, far_ = 0.0, noted_ = 0.0;
  int most_ = 0, count_ = 0;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
