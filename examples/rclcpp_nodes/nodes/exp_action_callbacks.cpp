// An action server accepts and rejects goals and cancellations.
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_action/rclcpp_action.hpp>
#include <std_msgs/msg/float64.hpp>
#include <test_msgs/action/fibonacci.hpp>

using Fibonacci = test_msgs::action::Fibonacci;
using GoalHandle = rclcpp_action::ServerGoalHandle<Fibonacci>;
using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("exp_action_callbacks") {
    limit_ = declare_parameter("limit", 5);
    late_ = declare_parameter("late", 3.0);
    noted_ = declare_parameter("noted", 4);
    pub_ = create_publisher<Float64>("~/output", 100);
    server_ = rclcpp_action::create_server<Fibonacci>(
        this, "~/count",
        [this](const rclcpp_action::GoalUUID &,
               std::shared_ptr<const Fibonacci::Goal> goal) {
          return onGoal(*goal);
        },
        std::bind(&Guard::onCancel, this, std::placeholders::_1),
        [](std::shared_ptr<GoalHandle> handle) {
          handle->succeed(std::make_shared<Fibonacci::Result>());
        });
    client_ = rclcpp_action::create_client<Fibonacci>(this, "~/count");
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
    client_->wait_for_action_server();
  }

private:
  rclcpp_action::GoalResponse onGoal(const Fibonacci::Goal &goal) {
    if (goal.order > noted_)
      RCLCPP_DEBUG(get_logger(), "noted");
    if (goal.order > limit_)
      return rclcpp_action::GoalResponse::REJECT;
    return rclcpp_action::GoalResponse::ACCEPT_AND_EXECUTE;
  }

  rclcpp_action::CancelResponse onCancel(std::shared_ptr<GoalHandle>) {
    return last_ > late_ ? rclcpp_action::CancelResponse::REJECT
                         : rclcpp_action::CancelResponse::ACCEPT;
  }

  void onInput(const Float64 &msg) {
    last_ = msg.data;
    Fibonacci::Goal goal;
    goal.order = static_cast<int>(msg.data);
    rclcpp_action::Client<Fibonacci>::SendGoalOptions options;
    options.goal_response_callback =
        [this](rclcpp_action::ClientGoalHandle<Fibonacci>::SharedPtr handle) {
          Float64 out;
          out.data = handle ? 1.0 : 0.0;
          pub_->publish(out);
        };
    client_->async_send_goal(goal, options);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  rclcpp_action::Server<Fibonacci>::SharedPtr server_;
  rclcpp_action::Client<Fibonacci>::SharedPtr client_;
  int limit_, noted_;
  double late_, last_ = 0.0;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
