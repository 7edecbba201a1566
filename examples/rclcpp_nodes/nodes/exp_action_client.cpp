// Whether a goal is sent, and with which number, depends on thresholds.
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_action/rclcpp_action.hpp>
#include <std_msgs/msg/float64.hpp>
#include <test_msgs/action/fibonacci.hpp>

using Fibonacci = test_msgs::action::Fibonacci;
using GoalHandle = rclcpp_action::ServerGoalHandle<Fibonacci>;
using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("exp_action_client") {
    limit_ = declare_parameter("limit", 2.0);
    most_ = declare_parameter("most", 5);
    noted_ = declare_parameter("noted", 4.0);
    client_ = rclcpp_action::create_client<Fibonacci>(this, "~/count");
    server_ = rclcpp_action::create_server<Fibonacci>(
        this, "~/count",
        [](const rclcpp_action::GoalUUID &,
           std::shared_ptr<const Fibonacci::Goal>) {
          return rclcpp_action::GoalResponse::ACCEPT_AND_EXECUTE;
        },
        [](std::shared_ptr<GoalHandle>) {
          return rclcpp_action::CancelResponse::ACCEPT;
        },
        [this](std::shared_ptr<GoalHandle> handle) {
          Float64 out;
          out.data = handle->get_goal()->order;
          pub_->publish(out);
          handle->succeed(std::make_shared<Fibonacci::Result>());
        });
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
    client_->wait_for_action_server();
  }

private:
  void onInput(const Float64 &msg) {
    Fibonacci::Goal goal;
    goal.order = static_cast<int>(msg.data);
    if (goal.order > most_)
      goal.order = most_;
    if (msg.data > noted_)
      RCLCPP_DEBUG(get_logger(), "noted");
    if (msg.data > limit_)
      client_->async_send_goal(goal);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  rclcpp_action::Server<Fibonacci>::SharedPtr server_;
  rclcpp_action::Client<Fibonacci>::SharedPtr client_;
  double limit_, noted_;
  int most_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
