// How a goal runs: feedback, result, and the way in which it ends.
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_action/rclcpp_action.hpp>
#include <std_msgs/msg/float64.hpp>
#include <test_msgs/action/fibonacci.hpp>

using Fibonacci = test_msgs::action::Fibonacci;
using GoalHandle = rclcpp_action::ServerGoalHandle<Fibonacci>;
using std_msgs::msg::Float64;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("exp_action_execute") {
    step_ = declare_parameter("step", 2);
    limit_ = declare_parameter("limit", 5);
    most_ = declare_parameter("most", 3);
    noted_ = declare_parameter("noted", 4);
    pub_ = create_publisher<Float64>("~/output", 100);
    using namespace std::placeholders;
    server_ = rclcpp_action::create_server<Fibonacci>(
        this, "~/count",
        [](const rclcpp_action::GoalUUID &,
           std::shared_ptr<const Fibonacci::Goal>) {
          return rclcpp_action::GoalResponse::ACCEPT_AND_EXECUTE;
        },
        [](std::shared_ptr<GoalHandle>) {
          return rclcpp_action::CancelResponse::ACCEPT;
        },
        std::bind(&Guard::execute, this, _1));
    client_ = rclcpp_action::create_client<Fibonacci>(this, "~/count");
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
    client_->wait_for_action_server();
  }

private:
  void execute(const std::shared_ptr<GoalHandle> handle) {
    const auto goal = handle->get_goal();
    auto feedback = std::make_shared<Fibonacci::Feedback>();
    auto result = std::make_shared<Fibonacci::Result>();
    for (int at = 0; at < goal->order; ++at) {
      feedback->sequence.push_back(at);
      if (at >= step_)
        handle->publish_feedback(feedback);
      if (at > noted_)
        RCLCPP_DEBUG(get_logger(), "noted");
    }
    if (goal->order > most_)
      result->sequence.push_back(goal->order);
    if (goal->order > limit_)
      handle->abort(result);
    else
      handle->succeed(result);
  }

  void onInput(const Float64 &msg) {
    Fibonacci::Goal goal;
    goal.order = static_cast<int>(msg.data);
    rclcpp_action::Client<Fibonacci>::SendGoalOptions options;
    options.result_callback =
        [this](const rclcpp_action::ClientGoalHandle<Fibonacci>::WrappedResult
                   &answer) {
          Float64 out;
          out.data = static_cast<double>(answer.code) +
                     10.0 * answer.result->sequence.size();
          pub_->publish(out);
        };
    client_->async_send_goal(goal, options);
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  rclcpp_action::Server<Fibonacci>::SharedPtr server_;
  rclcpp_action::Client<Fibonacci>::SharedPtr client_;
  int step_, limit_, most_, noted_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
